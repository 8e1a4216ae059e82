#pragma once

#include <iosfwd>

#include "viewer/answers/force_answers.hpp"

namespace palpate {

/// One step of the tool's path, with its answer.
struct WayStep {
  TouchInput touch;
  ForceAnswer answer;
  double way = 0;  ///< m, length of the path since the first step
};

/// Largest number of steps of a straight path. Each step makes a file of a series.
inline constexpr int most_steps = 100000;

/// Returns the touches of a path. They are `steps` + 1 touches on a straight line from rest to the
/// displacement in `words`. If `words` is "-", the touches are read from the input, one per line
/// (forEachTouch), and `steps` must be 0. Error (bad input) if `steps` is 0 or too large, or if the
/// input is empty. Error with the exit code of an interrupt if a signal interrupts this process;
/// the signal also ends the input.
std::vector<TouchInput> touchWay(const std::vector<std::string>& at,
                                 const std::vector<std::string>& words, int steps,
                                 std::istream& input, double workspace_radius);

/// Returns the single touch with the displacement in `words`, which must not be "-".
TouchInput onlyTouch(const std::vector<std::string>& at, const std::vector<std::string>& words,
                     double workspace_radius);

/// Returns the answer for each touch, and the length of the path up to each. A finger's position is
/// its displacement added to the surface point nearest to the requested place. `answers` must be
/// made with places if the touches have places. Error (bad input) as in ForceAnswers::answer. Error
/// with the exit code of an interrupt if this process is interrupted.
std::vector<WayStep> followWay(const std::vector<TouchInput>& touches, const ForceAnswers& answers);

/// Returns a force curve as CSV: a line of titles with units (way_m, force_x_N, ...), then one line
/// per step. Numbers have the fewest digits that identify them. A cell is empty if the method does
/// not provide its number; `inside` is 1 or 0. For a finger, each line also has its place and
/// drive.
std::string forceCurve(const std::vector<WayStep>& way);

}  // namespace palpate
