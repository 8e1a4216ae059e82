#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

/// A finer surface through the vertices of a triangle surface, for display. Every triangle becomes
/// four; the midpoints of its edges lie where a smooth surface with these normals would have them
/// (PN triangles, Vlachos et al. 2001). Vertices keep their places and numbers, and the midpoints
/// follow them. Sharp edges stay straight. Immutable.
class SurfaceRounding {
 public:
  /// corners: three vertices per triangle. vertices: number of vertices.
  SurfaceRounding(std::span<const std::uint32_t> corners, std::size_t vertices);

  std::size_t vertices() const { return vertices_ + ends_.size() / 2; }  ///< of the finer surface
  std::span<const std::uint32_t> corners() const { return corners_; }    ///< of the finer surface
  /// Computes the columns of the midpoints from those of the vertices, in the same arrays, which
  /// may have further columns. normals: unit.
  void fill(Eigen::Matrix3Xf& positions, Eigen::Matrix3Xf& normals) const;
  /// Sets the values of the midpoints to the means of their edge ends.
  void fill(std::vector<float>& values) const;

 private:
  std::size_t vertices_;
  std::vector<std::uint32_t> ends_;  ///< two vertices per edge
  std::vector<std::uint32_t> corners_;
};

}  // namespace palpate
