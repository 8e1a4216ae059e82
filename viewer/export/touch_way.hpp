#pragma once

#include <iosfwd>

#include "viewer/answers/force_answers.hpp"

namespace palpate {

/// One touch of a way of the tool, and what is felt there.
struct WayStep {
  TouchInput touch;
  ForceAnswer answer;
  double way = 0;  ///< m, that the tool has gone since the first step
};

/// More steps of a straight way are refused: a file for each.
inline constexpr int most_steps = 100000;

/// The touches of a way: from rest straight to the displacement in `words` in so many steps, rest
/// included; or, where `words` is "-", one per line of the input (forEachTouch), and no `steps`
/// (0). Error (bad input) when there are none or too many, or none in the input; Error with the
/// exit code of an interrupt when this process is interrupted, which ends the input too.
std::vector<TouchInput> touchWay(const std::vector<std::string>& at,
                                 const std::vector<std::string>& words, int steps,
                                 std::istream& input, double workspace_radius);

/// The only touch: the displacement in `words`, which is not "-".
TouchInput onlyTouch(const std::vector<std::string>& at, const std::vector<std::string>& words,
                     double workspace_radius);

/// What is felt at each touch. A finger goes between the points of the surface where it is, which
/// are the nearest to the places that were asked for. `answers` are for places where the touches
/// have some. Error (bad input) as ForceAnswers::answer; Error with the exit code of an interrupt
/// when this process is interrupted.
std::vector<WayStep> followWay(const std::vector<TouchInput>& touches, const ForceAnswers& answers);

}  // namespace palpate
