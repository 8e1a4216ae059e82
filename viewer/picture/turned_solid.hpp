#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

/// A corner of the profile of a solid: so far from the axis, so high along it.
struct ProfilePoint {
  double radius = 0, height = 0;
};

/// A solid of revolution about z, drawn as it is lit (SoftLight). Belongs to the thread in which
/// OpenGL is current.
class TurnedSolid {
 public:
  /// profile: upward, at least two points; a corner with edges is said twice. around: corners of
  /// its circles. Small solids need few, and triangles cost the more the smaller they are.
  TurnedSolid(std::span<const ProfilePoint> profile, int around);
  static TurnedSolid ball();      ///< radius 1 around the origin
  static TurnedSolid cylinder();  ///< radius 1 from z = 0 to 1
  static TurnedSolid disc();      ///< the same, rounder
  static TurnedSolid cone();      ///< radius 1 at z = 0, its tip at z = 1
  static TurnedSolid handle();    ///< a cylinder whose end at z = 1 is round
  /// A round tip of radius 1 around the origin, and a finger from there to z = 3.
  static TurnedSolid finger();

  /// The origin at `place`, z along `axis` (unit); `wide` times as wide, `long` times as long.
  void draw(const Eigen::Vector3d& place, const Eigen::Vector3d& axis, double wide,
            double length) const;

 private:
  std::vector<float> positions_, normals_;  ///< [vertex][axis]
  std::vector<std::uint32_t> corners_;
};

}  // namespace palpate
