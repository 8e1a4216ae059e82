#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace palpate {

/// Who started this process and watches it: systemd, or whoever speaks as it does (sd_notify(3), a
/// datagram to the socket that $NOTIFY_SOCKET names). Without one nothing happens. A message that
/// cannot be sent is told once (log), and the work goes on. One thread.
class ServiceManager {
 public:
  using Clock = std::chrono::steady_clock;

  /// From the environment, out of which it is taken: processes that are started are not this one.
  ServiceManager();

  bool isThere() const { return !socket_.empty(); }
  /// The start, or what is done now, may take so long before the next word.
  void mayTake(std::chrono::seconds longest, const std::string& what);
  /// From now on it serves, and mayTake() is over. To be said also when there is nothing to do.
  void ready();
  /// Call in every turn: says that the process lives as often as it is to (half of $WATCHDOG_USEC),
  /// and every five seconds how far it is.
  void alive(Clock::time_point now, const std::function<std::string()>& status);
  void stopping();

 private:
  void sendAndWatch(const std::string& lines, std::chrono::microseconds longest);
  void send(const std::string& lines);

  std::string socket_;                     ///< a path, or a name that begins with @; empty: nobody
  std::chrono::microseconds watchdog_{0};  ///< 0: nobody waits for a sign of life
  Clock::time_point next_sign_, next_status_;
  bool failed_ = false;
};

}  // namespace palpate
