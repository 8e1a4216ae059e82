#pragma once

#include "viewer/haptics/blended_force.hpp"
#include "viewer/haptics/contact_options.hpp"

namespace palpate {

/// Slides the anchor along the surface in the direction in which the contact energy W (Contact)
/// falls most steeply, also across edges and vertices.
///
/// Stops when |T| <= friction F.n (T, F and n as in Contact), when the distance allowed in one tick
/// is used up, or after a few evaluations of the force; the next tick continues. tool: position of
/// the tool, m; the displacement is tool - anchor. motion: length of the tool's motion in this
/// tick, m. force: the force at the anchor, both before and after the call, not judged. Each step
/// stays in one triangle and is undone if W would grow, so W never grows. The anchor stays on
/// touchable triangles. Real time.
void slideAnchor(const HapticModel& model, std::size_t method, const ContactOptions& options,
                 const Eigen::Vector3d& tool, double motion, SurfacePoint& anchor,
                 BlendedForce& force) noexcept;

}  // namespace palpate
