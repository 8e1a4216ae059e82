#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace palpate {

/// Returns the unit vectors at which functions of a direction are tabulated. They are spread evenly
/// over the unit sphere (a Fibonacci lattice, sorted by falling z), about 7 degrees apart.
const std::vector<Eigen::Vector3d>& tableDirections();

/// Weights that interpolate a function tabulated at tableDirections() to one direction. They are a
/// partition of unity, and twice continuously differentiable functions of the direction.
struct DirectionWeights {
  /// unit: the direction, a unit vector. Real time.
  explicit DirectionWeights(const Eigen::Vector3d& unit) noexcept;

  static constexpr std::size_t most = 32;
  std::size_t size = 0;                         ///< number of used entries of the arrays
  std::array<std::uint16_t, most> numbers;      ///< indices in tableDirections()
  std::array<double, most> weights;             ///< sum: 1
  std::array<Eigen::Vector3d, most> gradients;  ///< of `weights`, tangential to the sphere
};

/// Returns the indices of the table directions that can have a non-zero weight together with
/// direction `number`, including `number`.
const std::vector<std::size_t>& directionsBeside(std::size_t number);

}  // namespace palpate
