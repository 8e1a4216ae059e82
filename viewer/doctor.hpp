#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// The result of one check.
struct Finding {
  enum class Verdict {
    good,
    note,  ///< works, but could be better
    bad,   ///< something does not work
  } verdict = Verdict::good;
  std::string topic;        ///< "real-time priority"
  std::string found;        ///< the result of the check
  std::string advice = {};  ///< remedy; empty if none is needed
};

/// Checks whether this machine can run the haptic client: real-time limits, timer, memory locking,
/// processor clock, display and the Haply service. Also asks palpate-worker for its solver kernels.
/// Changes nothing and opens no device. Takes a second, to measure the wake-up latency of the
/// timer.
std::vector<Finding> examineMachine();

/// Formats the findings as text, one or two lines each, or as JSON, one object per line.
std::string describe(const std::vector<Finding>& findings);
std::string describeJson(const std::vector<Finding>& findings);

/// Returns the verb `doctor` of palpate-viewer, which prints the findings. Exit code 0, or 1 if
/// something does not work.
Verb doctorVerb();

}  // namespace palpate
