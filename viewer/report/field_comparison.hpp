#pragma once

#include <memory>

#include "viewer/fields/force_field.hpp"
#include "viewer/report/error_measures.hpp"
#include "viewer/report/held_out.hpp"

namespace palpate {

/// A field, or the reason why it could not be made.
struct MadeField {
  std::unique_ptr<ForceField> field;  ///< null if it could not be made
  std::string problem;                ///< empty if it could
};
MadeField tryToMake(const std::string& method, const SpaceTable& space);

/// Returns the work of a force field around closed loops relative to the effort, |sum F . dp| / sum
/// |F| |dp|: the maximum over circles.
///
/// The circles have a quarter of `radius` (metres, of the workspace ball), random centres and
/// planes from a fixed seed, and lie inside the ball. The result is zero for a conservative field,
/// up to the error of 4096-point quadrature (about 1e-9). Circles with coverage below
/// `least_coverage` anywhere are skipped, and up to 64 are used; NaN if none is left. Takes about
/// 0.1 s.
double loopWork(const ForceField& field, double radius, double least_coverage = 0);

/// One method at the held-out solutions of one active node.
struct MethodComparison {
  std::string problem;                       ///< why the method could not be made; otherwise empty
  std::vector<ForceComparison> comparisons;  ///< one per solution; empty if it could not be made
  double loop_work = not_measured;           ///< loopWork
};

/// Makes every method on `space` and evaluates it at every held-out solution.
///
/// A method that interpolates in cells decides once which solutions are covered, so the covered set
/// is the same for all methods. Work around closed loops takes longer than all the rest and is
/// measured only `with_loops`.
std::vector<MethodComparison> compareMethods(const SpaceTable& space,
                                             const std::vector<std::string>& methods,
                                             const std::vector<HeldOutSolution>& held_out,
                                             bool with_loops);

struct MethodTiming {
  double nanoseconds = not_measured;         ///< per query, median, on this machine
  double seconds_to_prepare = not_measured;  ///< to make the field, on this machine
};

/// Times queries at random positions in the ball for about `seconds`, in this thread; returns the
/// median over batches. NaN if the method cannot be made.
MethodTiming timeMethod(const SpaceTable& space, const std::string& method, double seconds);

/// Returns whether a sample uses only eight solved corners on one branch.
bool isCovered(const ForceSample& sample) noexcept;

}  // namespace palpate
