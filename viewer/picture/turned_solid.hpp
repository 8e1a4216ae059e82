#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

/// A corner of the profile of a solid: distance from the axis, and height along the axis.
struct ProfilePoint {
  double radius = 0, height = 0;
};

/// A solid of revolution about z. It is drawn with the current light (SoftLight), by the thread in
/// which OpenGL is current.
class TurnedSolid {
 public:
  /// profile: its points from below to above, at least two; repeat a point for a sharp edge.
  /// around: number of corners of its circles. A small solid needs few corners. Many small
  /// triangles would take much time.
  TurnedSolid(std::span<const ProfilePoint> profile, int around);
  static TurnedSolid ball();                ///< radius 1 around the origin
  static TurnedSolid cylinder(int around);  ///< radius 1 from z = 0 to 1
  static TurnedSolid cone();                ///< radius 1 at z = 0, tip at z = 1
  static TurnedSolid handle();              ///< a cylinder with a rounded end at z = 1
  /// A round tip of radius 1 around the origin, from which a finger extends to z = 3.
  static TurnedSolid finger();

  /// Draws the solid with its origin at `place` and its z axis along `axis` (unit). It is scaled by
  /// `wide` across the axis and by `length` along the axis.
  void draw(const Eigen::Vector3d& place, const Eigen::Vector3d& axis, double wide,
            double length) const;

 private:
  std::vector<float> positions_, normals_;  ///< [vertex][axis]
  std::vector<std::uint32_t> corners_;
};

}  // namespace palpate
