#pragma once

namespace palpate {

/// Smallest force that relative errors are taken of, N; it avoids division by zero. It is about the
/// friction of a haptic device, below which a hand feels nothing.
inline constexpr double relative_error_floor = 0.05;

/// Relative force error that datasets are usually built to.
inline constexpr double usual_force_error = 0.03;

/// Smallest relative change of a force that a hand notices: Weber's fraction, 7 to 10 % from 0.5 to
/// 200 N, more below (Jones 2000, Kinesthetic sensing).
inline constexpr double noticeable_force_error = 0.07;

}  // namespace palpate
