#pragma once

namespace palpate {

/// Forces below it count as this much in relative errors, which would else divide by zero (N):
/// about the friction of a haptic device, below which a hand feels nothing.
inline constexpr double relative_error_floor = 0.05;

/// What a dataset is usually built to: the error of a force as a share of it.
inline constexpr double usual_force_error = 0.03;

/// The smallest change of a force that a hand notices, as a share of it: Weber's fraction, 7 to 10
/// % from 0.5 to 200 N, more below (Jones 2000, Kinesthetic sensing).
inline constexpr double noticeable_force_error = 0.07;

}  // namespace palpate
