#pragma once

namespace palpate {

/// Returns the smallest number that is at least `value` (up to rounding) and is 1, 2 or 5 times a
/// power of ten. Scales and grids use such numbers for their ends and steps. value: positive and
/// finite.
double roundUp(double value);

}  // namespace palpate
