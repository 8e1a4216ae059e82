#pragma once

namespace palpate {

/// The smallest of 1, 2 and 5 times a power of ten that is at least `value`, but for rounding: the
/// numbers that scales and grids end and step by. value: positive and finite.
double roundUp(double value);

}  // namespace palpate
