#include "scheduler/service/peer_log.hpp"

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

bool PeerLog::mayTell() {
  const auto left_out = budget_.spend(clock_);
  if (left_out.value_or(0) > 0)
    spdlog::warn(
        "workers come, go or are refused faster than anybody reads: {} lines about them "
        "were left out; palpate status says how many are here, were refused or lost",
        *left_out);
  return left_out.has_value();
}

}  // namespace palpate
