#pragma once

#include "viewer/export/touch_way.hpp"

namespace palpate {

/// Returns a force curve as CSV: a line of titles with units (way_m, force_x_N, ...), then one line
/// per step. Numbers have the fewest digits that identify them. A cell is empty if the method does
/// not provide its number; `inside` is 1 or 0. For a finger, each line also has its place and
/// drive.
std::string forceCurve(const std::vector<WayStep>& way);

}  // namespace palpate
