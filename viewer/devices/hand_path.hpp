#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// A target position of a hand, and its time.
struct HandWaypoint {
  double time = 0;                                     ///< s, ascending
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m, scene frame
  std::uint32_t buttons = 0;  ///< held until the next waypoint; bit n: button n
};

/// The interpolated target at a time.
struct HandTarget {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m, scene frame
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s
  std::uint32_t buttons = 0;
};

/// A path through waypoints, with continuous position and velocity (C1), which starts and ends at
/// rest. Between two waypoints each coordinate stays between its values at these waypoints, so a
/// path never presses deeper than its waypoints.
///
/// The segments are cubic Hermite polynomials. At a waypoint where a coordinate changes direction,
/// its slope is zero. Elsewhere it is the harmonic mean of the slopes of the two neighbouring
/// segments, weighted for unequal time steps (Fritsch and Butland 1984).
class HandPath {
 public:
  enum class AtEnd : std::uint8_t { stays, repeats };

  /// Throws Error (bad input) if there is no waypoint, times do not ascend, a number is not finite,
  /// or a repeating path does not end where it starts. `source` names the path in errors.
  explicit HandPath(std::vector<HandWaypoint> waypoints, AtEnd at_end = AtEnd::stays,
                    const std::string& source = "path");

  /// Returns the target at a time, s. Before the first waypoint this is the first waypoint's
  /// position. After the last one it is the last waypoint's position or, if the path repeats, a
  /// position in a later round. Real time.
  HandTarget at(double time) const noexcept;
  double beginning() const { return waypoints_.front().time; }              ///< s
  double duration() const { return waypoints_.back().time - beginning(); }  ///< of one round, s
  bool repeats() const { return at_end_ == AtEnd::repeats; }
  const std::vector<HandWaypoint>& waypoints() const { return waypoints_; }

 private:
  std::vector<HandWaypoint> waypoints_;
  std::vector<Eigen::Vector3d> velocities_;  ///< m/s, at the waypoints
  AtEnd at_end_;
};

/// Reads lines of "TIME X Y Z [BUTTONS]" (seconds, metres, an integer). "#" starts a comment; the
/// word "repeat" on the last line repeats the path for ever. Throws Error (bad input) with file and
/// line.
HandPath readHandPath(const std::filesystem::path& file);

}  // namespace palpate
