#pragma once

#include <memory>

#include "viewer/fields/force_field.hpp"
#include "viewer/report/error_measures.hpp"
#include "viewer/report/held_out.hpp"

namespace palpate {

/// A field, or the reason why it could not be made.
struct MadeField {
  std::unique_ptr<ForceField> field;  ///< null if it could not be made
  std::string problem;                ///< the reason; empty if the field could be made
};
MadeField tryToMake(const std::string& method, const SpaceTable& space);

/// Returns the largest relative work of a force field around closed loops, |sum F . dp| / sum |F|
/// |dp|. It is zero for a conservative field, up to the error of the quadrature with 4096 points
/// (about 1e-9).
///
/// The loops are circles inside the workspace ball. Their radius is a quarter of `radius` (metres,
/// of the ball), and their centres and planes are random with a fixed seed. A circle is skipped if
/// the coverage is below `least_coverage` anywhere on it. At most 64 circles are used; returns NaN
/// if none is left. Takes about 0.1 s.
double loopWork(const ForceField& field, double radius, double least_coverage = 0);

/// Results of one method at the held-out solutions of one active node.
struct MethodComparison {
  std::string problem;                       ///< why the method could not be made; otherwise empty
  std::vector<ForceComparison> comparisons;  ///< one per solution; empty if the method could not be
                                             ///< made
  double loop_work = not_measured;           ///< result of loopWork()
};

/// Makes the field of every method from `space` and evaluates it at every held-out solution.
///
/// One method whose coverage depends only on the corners of a cell decides which solutions are
/// covered, so the covered solutions are the same for all methods. `with_loops`: also measures the
/// work around closed loops, which takes longer than everything else.
std::vector<MethodComparison> compareMethods(const SpaceTable& space,
                                             const std::vector<std::string>& methods,
                                             const std::vector<HeldOutSolution>& held_out,
                                             bool with_loops);

struct MethodTiming {
  double nanoseconds = not_measured;         ///< median time of one query on this machine
  double seconds_to_prepare = not_measured;  ///< time to make the field on this machine
};

/// Measures the time of queries at random positions in the ball for about `seconds`, in this
/// thread, and returns the median over batches of queries. The times are NaN if the method cannot
/// be made.
MethodTiming timeMethod(const SpaceTable& space, const std::string& method, double seconds);

/// Returns whether a sample is interpolated from eight solved corners on one branch.
bool isCovered(const ForceSample& sample) noexcept;
/// Returns the force of a sample, N; not_measured if the field gives no answer there.
Eigen::Vector3d forceInside(const ForceSample& sample) noexcept;

}  // namespace palpate
