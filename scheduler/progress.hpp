#pragma once

#include <chrono>

#include "scheduler/service/coordinator.hpp"

namespace palpate {

/// Shows on stderr how far a build is: a bar that redraws itself in one row of a terminal, else a
/// line every half minute. Nothing when only warnings are wanted (--quiet).
class Progress {
 public:
  Progress();
  /// Shows the status when it is time to.
  void show(const Coordinator& coordinator);
  /// Ends the bar's line.
  void end();

 private:
  bool wanted_;
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point next_;
};

}  // namespace palpate
