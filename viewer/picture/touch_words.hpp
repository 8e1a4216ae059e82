#pragma once

#include <string>
#include <vector>

#include "common/scene/scene.hpp"
#include "viewer/haptics/haptic_tick.hpp"

namespace palpate {

/// Whether the error bound is so large a share of the force that a hand could notice the error
/// (noticeable_force_error). Not without a bound, nor where nothing is touched.
bool isUncertain(const Touch& touch);
/// The force in the hand with the error bound of the tissue's, and that it is uncertain, where it
/// is: what stands at the arrow. Empty where there is neither touch nor force.
std::string forceText(const HapticState& state);
/// The same of the tissue alone.
std::string tissueForceText(const Touch& touch);
/// Why nothing is touched of the dataset that is shown beside another. one_mesh: it is of that
/// one's. one_scale: both are seen by one camera.
std::string untouchedText(bool one_mesh, bool one_scale);
/// "Mooney-Rivlin, Young's modulus 3.6 kPa": the first of the regions, and how many others there
/// are.
std::string tissueText(const std::vector<Region>& regions);

}  // namespace palpate
