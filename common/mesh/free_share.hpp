#pragma once

#include <vector>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Whether a finger of one radius lies on nodes that can move, by FingerWeights::free_share at any
/// place, for a loop. Copies what it needs; immutable: any thread may ask.
class FreeShare {
 public:
  /// radius > 0, metres; `fixed` sorted.
  FreeShare(const Mesh& mesh, const NodeSet& fixed, double radius);
  /// Whether less than this share does, 0 to 1; never where nothing fixed is near. Real time: some
  /// microseconds, a hundred beside fixed nodes, and a thousand where the share is about the one
  /// asked for.
  bool isBelow(double share, const Eigen::Vector3d& center) const noexcept;

 private:
  /// One triangle of the surface.
  struct Part {
    Eigen::AlignedBox3d box;
    Eigen::Matrix3d corners;       ///< one per column, m
    std::array<double, 6> free{};  ///< 1 or 0: of its vertices, then of the middles of 01, 12, 20
    bool is_quadratic = false;
  };
  static double freeAt(const Part& part, const Eigen::Vector3d& barycentric) noexcept;
  bool isNear(const Part& part, const Eigen::Vector3d& center) const noexcept;
  double shareAt(const Eigen::Vector3d& center, double part_of_radius) const noexcept;

  const double radius_;
  std::vector<Part> parts_;     ///< those with a fixed node first
  std::size_t with_fixed_ = 0;  ///< how many they are
};

}  // namespace palpate
