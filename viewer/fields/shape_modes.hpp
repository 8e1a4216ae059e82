#pragma once

#include <Eigen/Core>

namespace palpate {

/// One shape or mode per row: [shape][node, axis].
using ShapeRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns orthonormal modes, one per row. Their linear combinations reproduce all `shapes` (at
/// least one shape, all finite). The error of every entry of a shape is at most `tolerance`, in the
/// unit of the shapes, or, if that is larger, the float precision of the largest shape. The modes
/// are a reduced basis, chosen greedily (Buffa et al., ESAIM: M2AN 46, 2012): each mode is the
/// direction of the shape with the largest remaining error.
///
/// If there are many shapes, the first modes are chosen from a few hundred shapes that are spread
/// evenly over the list. Then all shapes are checked, and more modes are chosen from shapes with
/// too large an error, until no such shape is left. The result may have a few more modes than a
/// choice from all shapes at once, but takes a fraction of the time.
ShapeRows modesOf(const ShapeRows& shapes, float tolerance);

}  // namespace palpate
