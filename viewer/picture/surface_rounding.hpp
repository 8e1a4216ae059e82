#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

/// A finer surface through the vertices of one of triangles, for the eye: every triangle becomes
/// four, with the middles of its edges where a smooth surface with these normals would have them
/// (PN triangles, Vlachos et al. 2001). Vertices stay where they are, numbered as before; the
/// middles follow. Edges that are sharp stay straight. Immutable.
class SurfaceRounding {
 public:
  /// corners: three vertices per triangle, of so many vertices.
  SurfaceRounding(std::span<const std::uint32_t> corners, std::size_t vertices);

  std::size_t vertices() const { return vertices_ + ends_.size() / 2; }  ///< of the finer one
  std::span<const std::uint32_t> corners() const { return corners_; }    ///< of the finer one
  /// Columns of the middles, from those of the vertices: both are columns of the same arrays, which
  /// may have more. normals: unit.
  void fill(Eigen::Matrix3Xf& positions, Eigen::Matrix3Xf& normals) const;
  /// Means of the ends.
  void fill(std::vector<float>& values) const;

 private:
  std::size_t vertices_;
  std::vector<std::uint32_t> ends_;  ///< two vertices per edge
  std::vector<std::uint32_t> corners_;
};

}  // namespace palpate
