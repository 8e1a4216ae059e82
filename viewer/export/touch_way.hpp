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

/// Limit of the steps of a straight path; each makes a file.
inline constexpr int most_steps = 100000;

/// Returns the touches of a path. They go straight from rest to the displacement in `words` in
/// `steps` steps, rest included. If `words` is "-", they are read from the input, one per line
/// (forEachTouch), and `steps` must be 0. Error (bad input) for no or too many steps, or an empty
/// input. Error with the exit code of an interrupt if this process is interrupted, which also ends
/// the input.
std::vector<TouchInput> touchWay(const std::vector<std::string>& at,
                                 const std::vector<std::string>& words, int steps,
                                 std::istream& input, double workspace_radius);

/// Returns the only touch: the displacement in `words`, which is not "-".
TouchInput onlyTouch(const std::vector<std::string>& at, const std::vector<std::string>& words,
                     double workspace_radius);

/// Returns the answer to each touch. Between two steps the path of a finger connects the points of
/// the surface nearest to the requested places. `answers` must be made for places if the touches
/// have some. Error (bad input) as in ForceAnswers::answer. Error with the exit code of an
/// interrupt if this process is interrupted.
std::vector<WayStep> followWay(const std::vector<TouchInput>& touches, const ForceAnswers& answers);

}  // namespace palpate
