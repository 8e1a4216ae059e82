#include "viewer/export/touch_way.hpp"

#include <sstream>

#include "common/base/error.hpp"
#include "common/base/program.hpp"

namespace palpate {
namespace {

/// Returns the position of the tool, m; for tools other than fingers, relative to the rest
/// position.
Eigen::Vector3d toolAt(const WayStep& step) {
  const auto& finger = step.answer.finger;
  return step.touch.displacement + (finger ? finger->at : Eigen::Vector3d::Zero());
}

}  // namespace

std::vector<TouchInput> touchWay(const std::vector<std::string>& at,
                                 const std::vector<std::string>& words, int steps,
                                 std::istream& input, double workspace_radius) {
  std::vector<TouchInput> touches;
  if (words == from_input) {
    if (steps != 0)
      throw badInput("omit --steps {}: with \"--displacement -\" each input line is a step", steps);
    forEachTouch(at, words, input, workspace_radius, [&](const TouchInput& touch) {
      endWhenInterrupted();
      if (std::ssize(touches) > most_steps)
        throw badInput("standard input has more than {} touches", most_steps + 1);
      touches.push_back(touch);
    });
    endWhenInterrupted();
    if (touches.empty()) throw badInput("standard input has no displacement: give X Y Z per line");
    return touches;
  }
  if (steps < 1 || steps > most_steps)
    throw badInput("--steps {}: a path from rest has 1 to {} steps", steps, most_steps);
  const TouchInput end = onlyTouch(at, words, workspace_radius);
  for (int n = 0; n <= steps; ++n)
    touches.push_back({end.at, static_cast<double>(n) / steps * end.displacement});
  return touches;
}

TouchInput onlyTouch(const std::vector<std::string>& at, const std::vector<std::string>& words,
                     double workspace_radius) {
  std::istringstream nothing;
  TouchInput only;
  forEachTouch(at, words, nothing, workspace_radius,
               [&](const TouchInput& touch) { only = touch; });
  return only;
}

std::vector<WayStep> followWay(const std::vector<TouchInput>& touches,
                               const ForceAnswers& answers) {
  std::vector<WayStep> way;
  for (const TouchInput& touch : touches) {
    endWhenInterrupted();
    WayStep step = {touch, answers.answer(touch)};
    if (!way.empty()) step.way = way.back().way + (toolAt(step) - toolAt(way.back())).norm();
    way.push_back(step);
  }
  return way;
}

}  // namespace palpate
