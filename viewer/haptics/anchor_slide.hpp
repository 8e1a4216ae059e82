#pragma once

#include <Eigen/Core>

#include "viewer/haptics/blended_force.hpp"

namespace palpate {

/// A point that slides over a surface, downhill on the stored energy.
struct SlideLimits {
  double friction = 0;      ///< Coulomb's coefficient
  double length = 0;        ///< m, at most
  double force_change = 0;  ///< of the force; `motion` and it give a second limit of the length:
  double motion = 0;        ///< m: twice the tool's motion and force_change |F| / |dF/dX| together
};

/// Moves `anchor` along the surface against the tangent of W, by the way of steepest descent at
/// edges and vertices, until |tangent| <= friction F.n or the way is used up; then `force` is that
/// at the anchor. tool: m, where the displacement is tool - anchor. Each piece of the way stays in
/// one triangle, and is taken back where W would grow, so W never does. The anchor stays on
/// touchable triangles. The way is cut off after a few evaluations and goes on in the next tick.
///
/// force: evaluated at the anchor before. Returns the way, m. Real time.
double slideAnchor(const HapticModel& model, std::size_t method, const Eigen::Vector3d& tool,
                   const SlideLimits& limits, SurfacePoint& anchor, BlendedForce& force) noexcept;

}  // namespace palpate
