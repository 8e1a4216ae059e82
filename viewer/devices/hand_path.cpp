#include "viewer/devices/hand_path.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/text_lines.hpp"
#include "common/base/whole_file.hpp"

namespace palpate {
namespace {

/// Returns the slope of a monotone cubic at the point between two segments, from their slopes and
/// time steps. The slope is zero if the coordinate changes direction there.
double slopeBetween(double before, double after, double step_before, double step_after) {
  if (before * after <= 0) return 0;
  const double a = 2 * step_after + step_before, b = step_after + 2 * step_before;
  return (a + b) / (a / before + b / after);
}

std::vector<Eigen::Vector3d> velocitiesIn(const std::vector<HandWaypoint>& waypoints) {
  std::vector<Eigen::Vector3d> velocities(waypoints.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 1; i + 1 < waypoints.size(); ++i) {
    const double before = waypoints[i].time - waypoints[i - 1].time;
    const double after = waypoints[i + 1].time - waypoints[i].time;
    const Eigen::Vector3d slope_before =
        (waypoints[i].position - waypoints[i - 1].position) / before;
    const Eigen::Vector3d slope_after = (waypoints[i + 1].position - waypoints[i].position) / after;
    for (int axis = 0; axis < 3; ++axis)
      velocities[i][axis] = slopeBetween(slope_before[axis], slope_after[axis], before, after);
  }
  return velocities;
}

void check(const std::vector<HandWaypoint>& waypoints, HandPath::AtEnd at_end,
           const std::string& source) {
  if (waypoints.empty())
    throw badInput("{}: no waypoints; write one per line: TIME X Y Z, in seconds and metres",
                   source);
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    if (!std::isfinite(waypoints[i].time) || !waypoints[i].position.allFinite())
      throw badInput("{}: waypoint {} is not finite", source, i + 1);
    if (i > 0 && waypoints[i].time <= waypoints[i - 1].time)
      throw badInput("{}: times must increase: waypoint {} at {} s follows one at {} s", source,
                     i + 1, waypoints[i].time, waypoints[i - 1].time);
  }
  if (at_end == HandPath::AtEnd::stays) return;
  if (waypoints.size() < 2)
    throw badInput("{}: one waypoint cannot be repeated; remove \"repeat\"", source);
  if (waypoints.back().position != waypoints.front().position)
    throw badInput(
        "{}: a repeated path must end where it begins: append a waypoint at ({}, {}, {})", source,
        waypoints.front().position.x(), waypoints.front().position.y(),
        waypoints.front().position.z());
}

/// Replaces comments by blanks, so that the line numbers stay the same.
std::string withoutComments(std::string text) {
  for (bool comment = false; char& c : text) {
    comment = c == '#' || (comment && c != '\n');
    if (comment) c = ' ';
  }
  return text;
}

HandWaypoint takeWaypoint(TextLines& lines) {
  HandWaypoint waypoint;
  waypoint.time = lines.takeFinite("a time in seconds");
  waypoint.position.x() = lines.takeFinite("x in metres");
  waypoint.position.y() = lines.takeFinite("y in metres");
  waypoint.position.z() = lines.takeFinite("z in metres");
  if (!lines.atEndOfLine())
    waypoint.buttons = lines.take<std::uint32_t>("the buttons, a whole number");
  lines.expectEndOfLine();
  return waypoint;
}

}  // namespace

HandPath::HandPath(std::vector<HandWaypoint> waypoints, AtEnd at_end, const std::string& source)
    : waypoints_(std::move(waypoints)), at_end_(at_end) {
  check(waypoints_, at_end, source);
  velocities_ = velocitiesIn(waypoints_);
}

HandTarget HandPath::at(double time) const noexcept {
  const auto resting = [](const HandWaypoint& waypoint) {
    return HandTarget{waypoint.position, Eigen::Vector3d::Zero(), waypoint.buttons};
  };
  // A repeating path ends where it starts, so whole rounds can be left out.
  if (repeats() && time > beginning())
    time = beginning() + std::fmod(time - beginning(), duration());
  if (!(time > beginning())) return resting(waypoints_.front());
  const auto next =
      std::upper_bound(waypoints_.begin(), waypoints_.end(), time,
                       [](double t, const HandWaypoint& waypoint) { return t < waypoint.time; });
  if (next == waypoints_.end()) return resting(waypoints_.back());
  const auto i = static_cast<std::size_t>(next - waypoints_.begin());
  const HandWaypoint &from = waypoints_[i - 1], &to = waypoints_[i];
  const double step = to.time - from.time, s = (time - from.time) / step;
  const double s2 = s * s, s3 = s2 * s;
  HandTarget target;
  target.position = (2 * s3 - 3 * s2 + 1) * from.position + (3 * s2 - 2 * s3) * to.position +
                    step * ((s3 - 2 * s2 + s) * velocities_[i - 1] + (s3 - s2) * velocities_[i]);
  target.velocity = (6 * s2 - 6 * s) / step * (from.position - to.position) +
                    (3 * s2 - 4 * s + 1) * velocities_[i - 1] + (3 * s2 - 2 * s) * velocities_[i];
  target.buttons = from.buttons;
  return target;
}

HandPath readHandPath(const std::filesystem::path& file) {
  TextLines lines(withoutComments(readText(file, "path of the hand")), file.string());
  std::vector<HandWaypoint> waypoints;
  auto at_end = HandPath::AtEnd::stays;
  while (lines.advance()) {
    if (at_end == HandPath::AtEnd::repeats) throw lines.wrong("nothing may follow \"repeat\"");
    if (lines.rest() == "repeat") {
      at_end = HandPath::AtEnd::repeats;
      continue;
    }
    const HandWaypoint waypoint = takeWaypoint(lines);
    // HandPath checks the order too, but cannot name the line.
    if (!waypoints.empty() && waypoint.time <= waypoints.back().time)
      throw lines.wrong("times must increase: {} s follows {} s", waypoint.time,
                        waypoints.back().time);
    waypoints.push_back(waypoint);
  }
  return HandPath(std::move(waypoints), at_end, file.string());
}

}  // namespace palpate
