#include "viewer/export/touch_way.hpp"

#include <cmath>
#include <sstream>

#include "common/base/assertion.hpp"
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

constexpr const char* axes = "xyz";

/// Formats a number with the fewest digits that identify it; empty if it is not finite.
std::string exact(double value) {
  // + 0.0 turns -0 into 0.
  return std::isfinite(value) ? fmt::format("{}", value + 0.0) : "";
}

/// Returns a line of the file. No title and no number needs quotes.
std::string lineOf(const std::vector<std::string>& cells) {
  return fmt::format("{}\n", fmt::join(cells, ","));
}

void addTitles(std::vector<std::string>& titles, const char* name, const char* unit) {
  for (int i = 0; i < 3; ++i) titles.push_back(fmt::format("{}_{}_{}", name, axes[i], unit));
}

std::vector<std::string> titlesOf(const ForceAnswer& answer) {
  std::vector<std::string> titles = {"step", "way_m"};
  if (answer.finger) addTitles(titles, "at", "m");
  addTitles(titles, "displacement", "m");
  addTitles(titles, "force", "N");
  titles.emplace_back("force_N");
  for (int row = 0; row < 3; ++row)
    addTitles(titles, fmt::format("stiffness_{}", axes[row]).c_str(), "N_per_m");
  if (answer.finger) addTitles(titles, "drive", "N");
  for (const char* title : {"energy_J", "error_bound_N", "coverage", "inside"})
    titles.emplace_back(title);
  return titles;
}

std::string stepLine(std::size_t number, const WayStep& step) {
  const auto& [touch, answer, length] = step;
  std::vector<std::string> cells = {std::to_string(number), exact(length)};
  const auto add = [&cells](const auto& vector) {
    for (int i = 0; i < 3; ++i) cells.push_back(exact(vector[i]));
  };
  const ForceSample& sample = answer.sample;
  if (answer.finger) add(answer.finger->at);
  add(touch.displacement);
  add(sample.force);
  cells.push_back(exact(sample.force.norm()));
  for (int row = 0; row < 3; ++row) add(sample.stiffness.row(row));
  if (answer.finger) add(answer.finger->drive);
  for (const double number_of : {sample.energy, sample.error_bound, sample.coverage})
    cells.push_back(exact(number_of));
  cells.emplace_back(sample.inside ? "1" : "0");
  return lineOf(cells);
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

std::string forceCurve(const std::vector<WayStep>& way) {
  PALPATE_ASSERT(!way.empty(), "a path must have a first step");
  std::string text = lineOf(titlesOf(way.front().answer));
  for (std::size_t n = 0; n < way.size(); ++n) text += stepLine(n, way[n]);
  return text;
}

}  // namespace palpate
