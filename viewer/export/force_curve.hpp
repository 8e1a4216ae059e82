#pragma once

#include "viewer/export/touch_way.hpp"

namespace palpate {

/// A force curve as CSV: a line of titles, each with its unit (way_m, force_x_N, ...), then one for
/// each step; numbers in as few digits as tell them from all others, nothing where a method has
/// none, inside 1 or 0. Of a finger each line has its place and drive too.
std::string forceCurve(const std::vector<WayStep>& way);

}  // namespace palpate
