#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

/// The edges of a surface of triangles along which its picture ends: those between a triangle that
/// faces the eye and one that does not. Drawn over it as soft lines they take away the steps of its
/// pixels, which several samples a pixel would do at four times the cost where a processor draws.
/// Of the shape at rest they are the outline. One thread.
class Contour {
 public:
  /// corners: three vertices per triangle, closed.
  explicit Contour(std::span<const std::uint32_t> corners);
  /// Two vertices per edge. positions: a column per vertex. Valid until the next call, which does
  /// not allocate.
  std::span<const std::uint32_t> edges(const Eigen::Matrix3Xf& positions,
                                       const Eigen::Vector3f& eye);

 private:
  struct Side {
    std::uint32_t from, to;             ///< vertices
    std::uint32_t triangle, neighbour;  ///< on both sides
  };
  std::vector<std::uint32_t> corners_, found_;
  std::vector<Side> sides_;
  std::vector<std::uint8_t> faces_eye_;  ///< by triangle
};

}  // namespace palpate
