#pragma once

#include <spdlog/spdlog.h>

#include <chrono>
#include <cstdint>

namespace palpate {

/// Lines of the log that peers cause. Peers come and go as often as they like, and the disk must
/// not fill with it: what is beyond the budget is left out, and the next line says how much. One
/// thread.
class PeerLog {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// A fleet of a thousand workers that starts, and a line a second after that.
  static constexpr std::int64_t burst = 1000;
  static constexpr std::chrono::seconds interval{1};

  explicit PeerLog(Time now) : filled_(now) {}

  template <class... Args>
  void info(Time now, spdlog::format_string_t<Args...> text, Args&&... args) {
    if (mayTell(now)) spdlog::info(text, std::forward<Args>(args)...);
  }
  template <class... Args>
  void warn(Time now, spdlog::format_string_t<Args...> text, Args&&... args) {
    if (mayTell(now)) spdlog::warn(text, std::forward<Args>(args)...);
  }
  template <class... Args>
  void error(Time now, spdlog::format_string_t<Args...> text, Args&&... args) {
    if (mayTell(now)) spdlog::error(text, std::forward<Args>(args)...);
  }

  /// Whether a line fits; it is counted as told, or as left out.
  bool mayTell(Time now);
  /// Since the last line that fitted.
  std::int64_t leftOut() const { return left_out_; }

 private:
  Time filled_;  ///< up to when lines were given
  std::int64_t lines_ = burst;
  std::int64_t left_out_ = 0;
};

}  // namespace palpate
