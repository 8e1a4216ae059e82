#pragma once

#include <string>
#include <vector>

#include "common/scene/scene.hpp"
#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/haptics/surface_pressures.hpp"

namespace palpate {

/// Returns whether the force is uncertain. It is uncertain if the displacement is beyond the
/// computed region, or if the relative error bound is so large that a hand could notice the error
/// (noticeable_force_error). A force without contact is certain. If the method gives no bound, only
/// the region decides.
bool isUncertain(const Touch& touch);
/// Returns the label at the arrow of a force: the magnitude, the error bound of the tissue's force,
/// and a note if the force is uncertain. Empty if there is neither contact nor force.
std::string forceText(const Eigen::Vector3d& force, const Touch& touch);
/// Returns the reason why the dataset shown beside the touched one cannot repeat the touch.
/// one_mesh: whether both have the same mesh. one_scale: whether one camera shows both well.
std::string untouchedText(bool one_mesh, bool one_scale);
/// Returns the material of the first region, and the number of further regions: "Mooney-Rivlin,
/// Young's modulus 3.6 kPa".
std::string tissueText(const std::vector<Region>& regions);

/// Returns a sentence that says why pressures are not shown. It names the key of the scene that
/// would store them, or gives the progress of their preparation. Empty if they can be shown.
std::string whyNoPressures(const SurfacePressures& pressures);

}  // namespace palpate
