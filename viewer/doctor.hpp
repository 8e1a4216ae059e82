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
/// processor clock, display and the Haply service. Also runs palpate-worker to find out which
/// solver kernels it uses. Changes nothing and opens no device. Takes a second, in which it
/// measures the wake-up latency of the timer.
std::vector<Finding> examineMachine();

/// Format the findings: as text of one or two lines each, or as JSON of one object per line.
std::string describe(const std::vector<Finding>& findings);
std::string describeJson(const std::vector<Finding>& findings);

/// The verb `doctor` of palpate-viewer, which prints the findings. Its exit code is 1 if something
/// does not work, otherwise 0.
extern const Verb doctor_verb;

}  // namespace palpate
