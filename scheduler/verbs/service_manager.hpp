#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace palpate {

/// Reports the state of this process to the service manager that started it: systemd, or another
/// that follows sd_notify(3) (a datagram to the socket named by $NOTIFY_SOCKET). Does nothing
/// without one. If a message cannot be sent, warns once (log) and sends no more. One thread.
class ServiceManager {
 public:
  using Clock = std::chrono::steady_clock;

  /// Reads the variables of sd_notify and removes them from the environment, so that child
  /// processes do not report.
  ServiceManager();

  bool isThere() const { return !socket_.empty(); }
  /// Announces that `what`, the start or another operation, may take up to `longest` without a
  /// further message.
  void mayTake(std::chrono::seconds longest, const std::string& what);
  /// Reports that the service is ready, and ends mayTake(). Call it even if there is nothing to
  /// serve.
  void ready();
  /// Call in every turn. Sends a watchdog message twice per watchdog interval ($WATCHDOG_USEC), and
  /// a status text every five seconds.
  void alive(Clock::time_point now, const std::function<std::string()>& status);
  void stopping();

 private:
  void sendAndWatch(const std::string& lines, std::chrono::microseconds longest);
  void send(const std::string& lines);

  std::string socket_;  ///< a path, or "@" and an abstract name; empty without a manager
  std::chrono::microseconds watchdog_{0};  ///< interval of the watchdog; 0 if there is none
  Clock::time_point next_sign_, next_status_;
  bool failed_ = false;
};

}  // namespace palpate
