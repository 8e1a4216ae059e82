#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace palpate {

/// Returns unit vectors at which functions of a direction are tabulated. They are spread evenly
/// over the sphere (a Fibonacci lattice, in order of falling z), some 7 degrees apart.
const std::vector<Eigen::Vector3d>& tableDirections();

/// A partition of unity over tableDirections(), at one direction; twice continuously
/// differentiable.
struct DirectionWeights {
  /// unit: a unit vector. Real time.
  explicit DirectionWeights(const Eigen::Vector3d& unit) noexcept;

  static constexpr std::size_t most = 32;
  std::size_t size = 0;                         ///< used entries of the arrays
  std::array<std::uint16_t, most> numbers;      ///< indices in tableDirections()
  std::array<double, most> weights;             ///< sum: 1
  std::array<Eigen::Vector3d, most> gradients;  ///< of the weights by the direction, tangential
};

/// Returns the table directions with a support that overlaps the support of direction `number`.
/// Includes itself.
const std::vector<std::size_t>& directionsBeside(std::size_t number);

}  // namespace palpate
