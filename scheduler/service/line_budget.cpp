#include "scheduler/service/line_budget.hpp"

#include <algorithm>

namespace palpate {

bool LineBudget::spend(Time now) {
  const std::int64_t earned = std::max<std::int64_t>(0, (now - filled_) / interval);
  filled_ += earned * interval;
  lines_ = std::min(burst, lines_ + earned);
  if (lines_ == 0) {
    ++left_out_;
    return false;
  }
  --lines_;
  return true;
}

}  // namespace palpate
