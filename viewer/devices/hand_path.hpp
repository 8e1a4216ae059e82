#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// Where a hand wants to be at a time.
struct HandWaypoint {
  double time = 0;                                     ///< s, ascending
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m, scene frame
  std::uint32_t buttons = 0;  ///< held from here to the next waypoint; bit n: button n
};

/// What a hand aims at, at one time.
struct HandTarget {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m, scene frame
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s
  std::uint32_t buttons = 0;
};

/// A way through waypoints: position and velocity are continuous (C1), and between two waypoints no
/// coordinate leaves the interval that they span, so a path that presses to a depth never presses
/// deeper. It begins and ends at rest.
///
/// Cubic Hermite pieces; a slope is zero where a coordinate turns, else the harmonic mean of the
/// slopes beside it, weighted for unequal steps (Fritsch and Butland 1984).
class HandPath {
 public:
  enum class AtEnd : std::uint8_t { stays, repeats };

  /// Error (bad input) when there is no waypoint, times do not ascend, a number is not finite, or a
  /// path that repeats does not end where it began. `source` names it in errors.
  explicit HandPath(std::vector<HandWaypoint> waypoints, AtEnd at_end = AtEnd::stays,
                    const std::string& source = "path");

  /// Real time. Before the first waypoint: its position; after the last: its position, or from the
  /// beginning.
  HandTarget at(double time) const noexcept;
  double beginning() const { return waypoints_.front().time; }              ///< s
  double duration() const { return waypoints_.back().time - beginning(); }  ///< s, once through
  bool repeats() const { return at_end_ == AtEnd::repeats; }
  const std::vector<HandWaypoint>& waypoints() const { return waypoints_; }

 private:
  std::vector<HandWaypoint> waypoints_;
  std::vector<Eigen::Vector3d> velocities_;  ///< m/s, in the waypoints
  AtEnd at_end_;
};

/// Reads lines of "TIME X Y Z [BUTTONS]" (seconds, metres, a whole number); "#" begins a comment;
/// the word "repeat" on the last line makes it go on forever. Error (bad input) with file and line.
HandPath readHandPath(const std::filesystem::path& file);

}  // namespace palpate
