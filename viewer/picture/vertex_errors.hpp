#pragma once

#include <vector>

#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// Returns the relative error bound of the force (relativeError) at each surface vertex, for a tool
/// that is pressed straight in by half the workspace radius. NaN if the vertex is not touchable, or
/// if the method gives no bound there. method: must be prepared. Evaluates the field once per
/// vertex; takes a few milliseconds in all.
std::vector<double> vertexErrors(const HapticModel& model, std::size_t method);

}  // namespace palpate
