#pragma once

#include <limits>
#include <string>
#include <vector>

#include "common/space/space_table.hpp"
#include "viewer/fields/force_field.hpp"
#include "viewer/report/error_measures.hpp"
#include "viewer/report/references.hpp"

namespace palpate {

/// One method at the references of one active node.
struct MethodComparison {
  std::string problem;  ///< why the method could not be made; empty when it could
  std::vector<ForceComparison> comparisons;  ///< one per reference; empty when it could not
  double loop_work =
      std::numeric_limits<double>::quiet_NaN();  ///< see loop_work.hpp; NaN: not measured
};

/// Makes every method of `space` and asks it at every reference. Whether a reference is covered is
/// decided once, by a method that interpolates in cells, so that "covered" is the same set for all.
/// The work around closed loops takes longer than all the rest, so it is measured only
/// `with_loops`.
std::vector<MethodComparison> compareMethods(const SpaceTable& space,
                                             const std::vector<std::string>& methods,
                                             const std::vector<Reference>& references,
                                             bool with_loops);

struct MethodTiming {
  double nanoseconds = std::numeric_limits<double>::quiet_NaN();         ///< per query
  double seconds_to_prepare = std::numeric_limits<double>::quiet_NaN();  ///< to make the field
};

/// Times queries at random positions of the ball, for about `seconds`: the median over batches, all
/// in this thread. NaN when the method cannot be made.
MethodTiming timeMethod(const SpaceTable& space, const std::string& method, double seconds);

/// Whether a sample stands on eight solved corners on one branch, and on nothing else.
bool isCovered(const ForceSample& sample) noexcept;

}  // namespace palpate
