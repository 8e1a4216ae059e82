#pragma once

#include <spdlog/spdlog.h>

#include "scheduler/service/line_budget.hpp"

namespace palpate {

/// Lines of the log that peers cause: what is beyond the budget is left out, and the next line says
/// how much. One thread.
class PeerLog {
 public:
  using Time = LineBudget::Time;
  explicit PeerLog(Time now) : budget_(now) {}

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
  std::int64_t leftOut() const { return budget_.leftOut(); }

 private:
  LineBudget budget_;
};

}  // namespace palpate
