#include "viewer/fields/shape_modes.hpp"

#include <algorithm>
#include <limits>

namespace palpate {
namespace {

/// The first modes are chosen from at least this many, but fewer than twice as many, shapes (or
/// from all shapes if there are fewer). More shapes are not needed, because shapes at neighbouring
/// lattice points are much alike.
constexpr Eigen::Index electors = 400;
/// Number of shapes checked together, so that their errors stay in a core's cache.
constexpr Eigen::Index block = 256;

Eigen::VectorXf largestEntries(const ShapeRows& rows) {
  return rows.rowwise().lpNorm<Eigen::Infinity>();
}

/// Appends modes until the modes also reproduce some further shapes. `missed`: the parts of these
/// shapes that `modes` do not reproduce, one row per shape.
void extend(ShapeRows& modes, ShapeRows missed, float tolerance) {
  Eigen::VectorXf misses = largestEntries(missed);
  // Ends at a full set of modes, one per entry of a shape, which leaves no error.
  for (Eigen::Index worst = 0;
       modes.rows() < modes.cols() && misses.maxCoeff(&worst) > tolerance;) {
    Eigen::RowVectorXd mode = missed.row(worst).cast<double>();
    // Orthogonalizes the mode again, because rounding leaves parts of other modes in it.
    mode -= (mode * modes.cast<double>().transpose()) * modes.cast<double>();
    const Eigen::RowVectorXf direction = mode.normalized().cast<float>();
    missed -= (missed * direction.transpose()) * direction;
    misses = largestEntries(missed);
    modes.conservativeResize(modes.rows() + 1, Eigen::NoChange);
    modes.bottomRows<1>() = direction;
  }
}

/// Returns the parts that `modes` do not reproduce, one row for each shape with an error above the
/// tolerance.
ShapeRows missedBy(const ShapeRows& modes, const ShapeRows& shapes, float tolerance) {
  ShapeRows found(0, shapes.cols());
  for (Eigen::Index first = 0; first < shapes.rows(); first += block) {
    const auto some = shapes.middleRows(first, std::min(block, shapes.rows() - first));
    ShapeRows missed = some;
    missed.noalias() -= (some * modes.transpose()).eval() * modes;
    const Eigen::VectorXf misses = largestEntries(missed);
    for (Eigen::Index n = 0; n < missed.rows(); ++n)
      if (misses[n] > tolerance) {
        found.conservativeResize(found.rows() + 1, Eigen::NoChange);
        found.bottomRows<1>() = missed.row(n);
      }
  }
  return found;
}

}  // namespace

ShapeRows modesOf(const ShapeRows& shapes, float tolerance) {
  const Eigen::Index stride = std::max<Eigen::Index>(1, shapes.rows() / electors);
  ShapeRows choosing((shapes.rows() + stride - 1) / stride, shapes.cols()), modes(0, shapes.cols());
  for (Eigen::Index n = 0; n < choosing.rows(); ++n) choosing.row(n) = shapes.row(n * stride);
  constexpr float rounding = 4 * std::numeric_limits<float>::epsilon();
  const float reachable = std::max(tolerance, rounding * shapes.rowwise().norm().maxCoeff());
  // Subtracting a mode from a shape may increase the error of some of its entries. All shapes are
  // therefore checked again until none has too large an error.
  while (choosing.rows() > 0 && modes.rows() < modes.cols()) {
    extend(modes, std::move(choosing), reachable);
    choosing = missedBy(modes, shapes, reachable);
  }
  return modes;
}

}  // namespace palpate
