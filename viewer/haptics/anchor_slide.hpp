#pragma once

#include "viewer/haptics/blended_force.hpp"
#include "viewer/haptics/contact_options.hpp"

namespace palpate {

/// Moves the anchor along the surface against the tangent of W (Contact), by the way of steepest
/// descent at edges and vertices, until |tangent| <= friction F.n or the way is used up; `force`,
/// of the anchor at first, is that at the anchor then. tool: m, where the displacement is tool -
/// anchor. motion: m, of the tool in this tick. Each piece of the way stays in one triangle, and is
/// taken back where W would grow, so W never does. The anchor stays on touchable triangles. The way
/// is cut off after a few evaluations and goes on in the next tick. Real time.
void slideAnchor(const HapticModel& model, std::size_t method, const ContactOptions& options,
                 const Eigen::Vector3d& tool, double motion, SurfacePoint& anchor,
                 BlendedForce& force) noexcept;

}  // namespace palpate
