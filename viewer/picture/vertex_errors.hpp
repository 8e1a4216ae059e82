#pragma once

#include <vector>

#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// By vertex of the surface, the error bound as a share of the force (relativeError) where a tool
/// presses it straight in, half the radius of its workspace deep. NaN: there is nothing to feel, or
/// the method gives no bound. method: one that is prepared. One evaluation a vertex: some
/// milliseconds.
std::vector<double> vertexErrors(const HapticModel& model, std::size_t method);

}  // namespace palpate
