#pragma once

namespace palpate {

/// Smallest force by which an error is divided to get a relative error, N. This limit avoids
/// division by zero. It is about the friction of a haptic device, below which a hand feels nothing.
inline constexpr double relative_error_floor = 0.05;

/// Relative force error that most datasets are built to meet.
inline constexpr double usual_force_error = 0.03;

/// Smallest relative change of a force that a hand notices: Weber's fraction, 7 to 10 % from 0.5 to
/// 200 N, more below (Jones 2000, Kinesthetic sensing).
inline constexpr double noticeable_force_error = 0.07;

}  // namespace palpate
