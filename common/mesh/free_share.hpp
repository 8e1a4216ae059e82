#pragma once

#include <vector>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Tests quickly whether a finger at a given place rests mostly on movable nodes
/// (FingerWeights::free_share). All fingers have the same radius. Copies the data it needs.
/// Immutable, so any thread may use it.
class FreeShare {
 public:
  /// `radius` must be > 0, metres, and `fixed` sorted.
  FreeShare(const Mesh& mesh, const NodeSet& fixed, double radius);
  /// Returns whether FingerWeights::free_share of a finger at `center` is below `share`, 0 to 1.
  /// Always false if the finger reaches no triangle with a fixed node. Real time: takes a few
  /// microseconds, near fixed nodes about 0.1 ms, and about 1 ms if the free share is close to
  /// `share`.
  bool isBelow(double share, const Eigen::Vector3d& center) const noexcept;

 private:
  /// A triangle of the surface.
  struct Part {
    Eigen::AlignedBox3d box;
    Eigen::Matrix3d corners;  ///< one per column, m
    /// 1 for a free node, 0 for a fixed one: corners, then mid-edge nodes of edges 01, 12, 20.
    std::array<double, 6> free{};
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
