#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// One thing that the doctor looked at.
struct Finding {
  enum class Verdict {
    good,
    note,  ///< it works, and could work better
    bad,   ///< something will not work
  } verdict = Verdict::good;
  std::string topic;        ///< "real-time priority"
  std::string found;        ///< what is so
  std::string advice = {};  ///< what to do about it; empty when there is nothing to do
};

/// Whether this machine can run the haptic client: real-time limits, timer, memory locking,
/// processor clock, display, the Haply service; and which kernels solve on it, as palpate-worker
/// says. Changes nothing, opens no device. Takes a second, in which it measures how late the timer
/// wakes a thread.
std::vector<Finding> examineMachine();

/// For a person, one or two lines per finding; and one JSON object per line.
std::string describe(const std::vector<Finding>& findings);
std::string describeJson(const std::vector<Finding>& findings);

/// The verb `doctor` of palpate-viewer: prints what was found. Exit 0, or 1 when something will not
/// work.
Verb doctorVerb();

}  // namespace palpate
