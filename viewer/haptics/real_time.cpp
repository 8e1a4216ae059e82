#include "viewer/haptics/real_time.hpp"

#include <fmt/format.h>
#include <sched.h>

#include <cstring>
#include <system_error>
#include <thread>

namespace palpate {

int refusalOfPriority(int wanted) {
  int refusal = 0;
  try {
    std::thread([&] {
      const sched_param priority = {wanted};
      refusal = pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority);
    }).join();
  } catch (const std::system_error& error) {
    return error.code().value();
  }
  return refusal;
}

std::string giveRealTime(pthread_t thread, const char* name, int wanted) {
  const sched_param priority = {wanted};
  const int refused = pthread_setschedparam(thread, SCHED_FIFO, &priority);
  if (refused == 0) return {};
  return fmt::format(
      "The {} thread has no real-time priority ({}), so other programs may delay it: allow the "
      "priority with ulimit -r {}, \"@realtime - rtprio {}\" in /etc/security/limits.conf, or "
      "LimitRTPRIO={} in a systemd unit. ",
      name, std::strerror(refused), highest_priority, highest_priority, highest_priority);
}

}  // namespace palpate
