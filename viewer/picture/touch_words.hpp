#pragma once

#include <string>
#include <vector>

#include "common/scene/scene.hpp"
#include "viewer/haptics/haptic_tick.hpp"

namespace palpate {

/// Returns whether the force is uncertain: the displacement is beyond the computed region, or the
/// relative error bound is so large that a hand could notice the error (noticeable_force_error).
/// False without contact, and inside the region without a bound.
bool isUncertain(const Touch& touch);
/// Returns the label at the arrow: the force in the hand with the error bound of the tissue's
/// force, and a note if it is uncertain. Empty without contact and force.
std::string forceText(const HapticState& state);
/// Returns the same for the tissue's force.
std::string tissueForceText(const Touch& touch);
/// Returns why the dataset shown beside another is not touched. one_mesh: both have the same mesh.
/// one_scale: one camera shows both.
std::string untouchedText(bool one_mesh, bool one_scale);
/// Returns "Mooney-Rivlin, Young's modulus 3.6 kPa": the first of the regions, and the number of
/// the others.
std::string tissueText(const std::vector<Region>& regions);

}  // namespace palpate
