#pragma once

#include <vector>

#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// Returns the relative error bound of the force (relativeError) per surface vertex, for a tool
/// pressed straight in by half the workspace radius. NaN: not touchable, or no bound by the method.
/// method: a prepared one. One evaluation per vertex, some milliseconds in all.
std::vector<double> vertexErrors(const HapticModel& model, std::size_t method);

}  // namespace palpate
