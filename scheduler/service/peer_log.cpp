#include "scheduler/service/peer_log.hpp"

namespace palpate {

bool PeerLog::mayTell(Time now) {
  if (!budget_.spend(now)) return false;
  if (const std::int64_t left_out = budget_.takeLeftOut(); left_out > 0)
    spdlog::warn(
        "workers come, go or are refused faster than anybody reads: {} lines about them "
        "were left out; palpate status says how many are here, were refused or lost",
        left_out);
  return true;
}

}  // namespace palpate
