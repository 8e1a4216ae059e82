#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

/// Silhouette edges of a triangle surface: one of the two triangles at such an edge faces the eye,
/// the other does not.
///
/// These edges are drawn over the surface as soft lines, which hide jagged pixels. Multisampling
/// would do the same at four times the cost when drawing in software. The ghost's outline consists
/// of the silhouette edges of the shape at rest. One thread.
class Contour {
 public:
  /// corners: three vertices per triangle of a closed surface.
  explicit Contour(std::span<const std::uint32_t> corners);
  /// Returns the silhouette edges, two vertices per edge. The result is valid until the next call.
  /// positions: one column per vertex. Does not allocate.
  std::span<const std::uint32_t> edges(const Eigen::Matrix3Xf& positions,
                                       const Eigen::Vector3f& eye);

 private:
  struct Side {
    std::uint32_t from, to;             ///< vertices
    std::uint32_t triangle, neighbour;  ///< the triangles on both sides of the edge
  };
  std::vector<std::uint32_t> corners_, found_;
  std::vector<Side> sides_;
  std::vector<std::uint8_t> faces_eye_;  ///< per triangle
};

}  // namespace palpate
