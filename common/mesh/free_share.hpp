#pragma once

#include <vector>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Fast test whether a finger of one radius rests on movable nodes at a given place, by
/// FingerWeights::free_share. Copies the data it needs. Immutable, so any thread may use it.
class FreeShare {
 public:
  /// radius > 0, metres; `fixed` sorted.
  FreeShare(const Mesh& mesh, const NodeSet& fixed, double radius);
  /// Returns whether the free share at `center` is below `share`, 0 to 1; always false if no fixed
  /// node is near. Real time: some microseconds, a hundred beside fixed nodes, and a thousand if
  /// the free share is close to `share`.
  bool isBelow(double share, const Eigen::Vector3d& center) const noexcept;

 private:
  /// One triangle of the surface.
  struct Part {
    Eigen::AlignedBox3d box;
    Eigen::Matrix3d corners;       ///< one per column, m
    std::array<double, 6> free{};  ///< 1 if free: vertices, then mid-edge nodes of 01, 12, 20
    bool is_quadratic = false;
  };
  static double freeAt(const Part& part, const Eigen::Vector3d& barycentric) noexcept;
  bool isNear(const Part& part, const Eigen::Vector3d& center) const noexcept;
  double shareAt(const Eigen::Vector3d& center, double part_of_radius) const noexcept;

  const double radius_;
  std::vector<Part> parts_;     ///< parts with a fixed node come first
  std::size_t with_fixed_ = 0;  ///< number of parts with a fixed node
};

}  // namespace palpate
