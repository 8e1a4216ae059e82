#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

/// A corner of a solid's profile: distance from the axis and height along it.
struct ProfilePoint {
  double radius = 0, height = 0;
};

/// A solid of revolution about z, drawn with the current light (SoftLight). Used by the thread in
/// which OpenGL is current.
class TurnedSolid {
 public:
  /// profile: upward, at least two points; repeat a point for a sharp edge. around: number of
  /// corners of its circles. Small solids need few corners, because small triangles cost more for
  /// their size.
  TurnedSolid(std::span<const ProfilePoint> profile, int around);
  static TurnedSolid ball();      ///< radius 1 around the origin
  static TurnedSolid cylinder();  ///< radius 1 from z = 0 to 1
  static TurnedSolid disc();      ///< the same, with more corners
  static TurnedSolid cone();      ///< radius 1 at z = 0, its tip at z = 1
  static TurnedSolid handle();    ///< a cylinder with a rounded end at z = 1
  /// A round tip of radius 1 around the origin, and a finger from there to z = 3.
  static TurnedSolid finger();

  /// Draws it with the origin at `place` and z along `axis` (unit), scaled by `wide` across and by
  /// `length` along the axis.
  void draw(const Eigen::Vector3d& place, const Eigen::Vector3d& axis, double wide,
            double length) const;

 private:
  std::vector<float> positions_, normals_;  ///< [vertex][axis]
  std::vector<std::uint32_t> corners_;
};

}  // namespace palpate
