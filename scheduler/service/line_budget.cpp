#include "scheduler/service/line_budget.hpp"

#include <algorithm>
#include <utility>

namespace palpate {

std::optional<std::int64_t> LineBudget::spend(Time now) {
  const std::int64_t earned = std::max<std::int64_t>(0, (now - filled_) / interval);
  filled_ += earned * interval;
  lines_ = std::min(burst, lines_ + earned);
  if (lines_ == 0) {
    ++left_out_;
    return std::nullopt;
  }
  --lines_;
  return std::exchange(left_out_, 0);
}

}  // namespace palpate
