#pragma once

#include <Eigen/Core>

namespace palpate {

/// A shape or a mode per row: [shape][node, axis].
using ShapeRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Orthonormal rows that span all `shapes`, at least one, to within `tolerance` in every entry
/// (both in the same unit; finite), or what float tells of the largest: a reduced basis, chosen
/// greedily (Buffa et al., ESAIM: M2AN 46, 2012), each time the direction of the shape that those
/// before it miss by most.
///
/// Of many shapes a few hundred, spread evenly, choose; then all are looked at, and those that are
/// still missed choose on, until none is. So a few more modes may be found than if all had chosen,
/// in a fraction of the time.
ShapeRows modesOf(const ShapeRows& shapes, float tolerance);

}  // namespace palpate
