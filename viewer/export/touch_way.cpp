#include "viewer/export/touch_way.hpp"

#include <sstream>

#include "common/base/error.hpp"
#include "common/base/interruption.hpp"

namespace palpate {
namespace {

bool isFromInput(const std::vector<std::string>& words) {
  return words.size() == 1 && words[0] == "-";
}

Eigen::Vector3d toolAt(const TouchInput& touch) {
  return touch.at.value_or(Eigen::Vector3d::Zero()) + touch.displacement;
}

void append(std::vector<WayStep>& way, const TouchInput& touch) {
  double length = 0;
  if (!way.empty()) length = way.back().way + (toolAt(touch) - toolAt(way.back().touch)).norm();
  way.push_back({touch, length});
}

}  // namespace

std::vector<WayStep> touchWay(const std::vector<std::string>& at,
                              const std::vector<std::string>& words, int steps, std::istream& input,
                              double workspace_radius) {
  std::vector<WayStep> way;
  if (isFromInput(words)) {
    if (steps != 0)
      throw badInput("--steps {}: with --displacement - every line of the input is a step", steps);
    forEachTouch(at, words, input, workspace_radius, [&](const TouchInput& touch) {
      endWhenInterrupted();
      if (std::ssize(way) > most_steps)
        throw badInput("standard input has more than {} touches", most_steps + 1);
      append(way, touch);
    });
    endWhenInterrupted();
    if (way.empty()) throw badInput("standard input has no displacement: one per line, X Y Z");
    return way;
  }
  if (steps < 1 || steps > most_steps)
    throw badInput("--steps {}: a way from rest has 1 to {} steps", steps, most_steps);
  const TouchInput end = onlyTouch(at, words, workspace_radius);
  for (int n = 0; n <= steps; ++n)
    append(way, {end.at, static_cast<double>(n) / steps * end.displacement});
  return way;
}

TouchInput onlyTouch(const std::vector<std::string>& at, const std::vector<std::string>& words,
                     double workspace_radius) {
  std::istringstream nothing;
  TouchInput only;
  forEachTouch(at, words, nothing, workspace_radius,
               [&](const TouchInput& touch) { only = touch; });
  return only;
}

}  // namespace palpate
