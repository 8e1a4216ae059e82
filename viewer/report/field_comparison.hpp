#pragma once

#include <memory>

#include "viewer/fields/force_field.hpp"
#include "viewer/report/error_measures.hpp"
#include "viewer/report/held_out.hpp"

namespace palpate {

/// A field, or why it could not be made.
struct MadeField {
  std::unique_ptr<ForceField> field;  ///< null when it could not
  std::string problem;                ///< empty when it could
};
MadeField tryToMake(const std::string& method, const SpaceTable& space);

/// The work that a force field does around closed loops, relative to the effort: |sum F . dp| / sum
/// |F| |dp|, the largest over circles of a quarter of `radius` (metres, of the workspace ball) with
/// random centres and planes from a fixed seed, all inside the ball. Zero for a conservative field,
/// apart from the error of 4096-point quadrature (some 1e-9). Circles on which the coverage falls
/// below `least_coverage` anywhere are left out, up to 64 are used; NaN when none is left. Takes
/// some 0.1 s.
double loopWork(const ForceField& field, double radius, double least_coverage = 0);

/// One method at the held-out solutions of one active node.
struct MethodComparison {
  std::string problem;                       ///< why the method could not be made, else empty
  std::vector<ForceComparison> comparisons;  ///< one per solution; empty when it could not
  double loop_work = not_measured;           ///< loopWork
};

/// Makes every method of `space` and asks it at every held-out solution. Whether a solution is
/// covered is decided once, by a method that interpolates in cells, so that "covered" is the same
/// set for all. The work around closed loops takes longer than all the rest, so it is measured only
/// `with_loops`.
std::vector<MethodComparison> compareMethods(const SpaceTable& space,
                                             const std::vector<std::string>& methods,
                                             const std::vector<HeldOutSolution>& held_out,
                                             bool with_loops);

struct MethodTiming {
  double nanoseconds = not_measured;         ///< per query, median, this machine
  double seconds_to_prepare = not_measured;  ///< to make the field, this machine
};

/// Times queries at random positions of the ball, for about `seconds`: the median over batches, all
/// in this thread. NaN when the method cannot be made.
MethodTiming timeMethod(const SpaceTable& space, const std::string& method, double seconds);

/// Whether a sample stands on eight solved corners on one branch, and on nothing else.
bool isCovered(const ForceSample& sample) noexcept;

}  // namespace palpate
