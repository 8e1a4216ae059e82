#pragma once

namespace palpate {

/// Returns the smallest of 1, 2 and 5 times a power of ten that is at least `value`, up to
/// rounding, for ends and steps of scales and grids. value: positive and finite.
double roundUp(double value);

}  // namespace palpate
