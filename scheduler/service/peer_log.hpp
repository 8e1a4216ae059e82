#pragma once

#include <spdlog/spdlog.h>

#include <chrono>
#include <cstdint>
#include <optional>

namespace palpate {

/// How many lines peers may cause. They come and go as often as they like, and the disk must not
/// fill with it. One thread.
class LineBudget {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// A fleet of a thousand workers that starts, and a line a second after that.
  static constexpr std::int64_t burst = 1000;
  static constexpr std::chrono::seconds interval{1};

  explicit LineBudget(Time now) : filled_(now) {}

  /// How many lines were left out since the last one, for which there is room now; nothing: this
  /// one is left out too.
  std::optional<std::int64_t> spend(Time now);

 private:
  Time filled_;  ///< up to when lines were given
  std::int64_t lines_ = burst;
  std::int64_t left_out_ = 0;
};

/// Lines of the log that peers cause: what is beyond the budget is left out, and the next line says
/// how much. One thread.
class PeerLog {
 public:
  using Time = LineBudget::Time;
  /// `clock` must outlive it.
  explicit PeerLog(const Time& clock) : clock_(clock), budget_(clock) {}

  template <class... Args>
  void info(spdlog::format_string_t<Args...> text, Args&&... args) {
    if (mayTell()) spdlog::info(text, std::forward<Args>(args)...);
  }
  template <class... Args>
  void warn(spdlog::format_string_t<Args...> text, Args&&... args) {
    if (mayTell()) spdlog::warn(text, std::forward<Args>(args)...);
  }
  template <class... Args>
  void error(spdlog::format_string_t<Args...> text, Args&&... args) {
    if (mayTell()) spdlog::error(text, std::forward<Args>(args)...);
  }

 private:
  bool mayTell();

  const Time& clock_;
  LineBudget budget_;
};

}  // namespace palpate
