#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

/// A finer surface through the vertices of a triangle surface, for display. Every triangle becomes
/// four. The midpoints of edges lie where a smooth surface with the given normals would have them
/// (PN triangles, Vlachos et al. 2001). The vertices keep their places and numbers; the midpoints
/// follow after them. Sharp edges stay straight. Immutable.
class SurfaceRounding {
 public:
  /// corners: three vertices per triangle. vertices: number of vertices of the given surface.
  SurfaceRounding(std::span<const std::uint32_t> corners, std::size_t vertices);

  std::size_t vertices() const { return vertices_ + ends_.size() / 2; }  ///< of the finer surface
  std::span<const std::uint32_t> corners() const { return corners_; }    ///< of the finer surface
  /// Computes the columns of the midpoints from those of the vertices. The arrays hold both, and
  /// may have more columns. normals: unit.
  void fill(Eigen::Matrix3Xf& positions, Eigen::Matrix3Xf& normals) const;
  /// Sets the value at each midpoint to the mean of the values at the ends of its edge.
  void fill(std::vector<float>& values) const;

 private:
  std::size_t vertices_;
  std::vector<std::uint32_t> ends_;  ///< two vertices per edge
  std::vector<std::uint32_t> corners_;
};

}  // namespace palpate
