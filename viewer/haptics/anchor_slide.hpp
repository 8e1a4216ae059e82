#pragma once

#include "viewer/haptics/blended_force.hpp"
#include "viewer/haptics/contact_options.hpp"

namespace palpate {

/// Slides the anchor along the surface down the gradient of the contact energy W (Contact).
///
/// Takes steepest descent at edges and vertices, and stops when |T| <= friction F.n or the allowed
/// distance is used up. `force` holds the force at the anchor, before and after. tool: m; the
/// displacement is tool - anchor. motion: motion of the tool in this tick, m. Each step stays in
/// one triangle and is undone if W would grow, so W never grows. The anchor stays on touchable
/// triangles. The slide stops after a few evaluations and goes on in the next tick. Real time.
void slideAnchor(const HapticModel& model, std::size_t method, const ContactOptions& options,
                 const Eigen::Vector3d& tool, double motion, SurfacePoint& anchor,
                 BlendedForce& force) noexcept;

}  // namespace palpate
