#pragma once

#include <Eigen/Core>

namespace palpate {

/// One shape or mode per row: [shape][node, axis].
using ShapeRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns orthonormal rows that span all `shapes` (at least one, finite). Every entry of a shape
/// is met within `tolerance`, in the unit of the shapes, or within the float precision of the
/// largest shape. They are a reduced basis, chosen greedily (Buffa et al., ESAIM: M2AN 46, 2012):
/// each mode is the direction of the shape with the largest remaining error.
///
/// If there are many shapes, a few hundred spread evenly provide the first modes. Then all shapes
/// are checked, and those with too large an error provide more modes, until none is left. This may
/// find a few more modes than a choice from all shapes, in a fraction of the time.
ShapeRows modesOf(const ShapeRows& shapes, float tolerance);

}  // namespace palpate
