#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

/// Edges along which the picture of a triangle surface ends: those between a triangle that faces
/// the eye and one that does not.
///
/// Drawn over the surface as soft lines they hide its jagged pixel edges. Multisampling would do
/// the same at four times the cost when drawing in software. For the shape at rest they are the
/// outline. One thread.
class Contour {
 public:
  /// corners: three vertices per triangle of a closed surface.
  explicit Contour(std::span<const std::uint32_t> corners);
  /// Returns the edges, two vertices each, valid until the next call. positions: one column per
  /// vertex. Does not allocate.
  std::span<const std::uint32_t> edges(const Eigen::Matrix3Xf& positions,
                                       const Eigen::Vector3f& eye);

 private:
  struct Side {
    std::uint32_t from, to;             ///< vertices
    std::uint32_t triangle, neighbour;  ///< on its two sides
  };
  std::vector<std::uint32_t> corners_, found_;
  std::vector<Side> sides_;
  std::vector<std::uint8_t> faces_eye_;  ///< per triangle
};

}  // namespace palpate
