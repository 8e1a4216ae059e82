#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace palpate {

/// Unit vectors spread evenly over the sphere (a Fibonacci lattice, z falling), some 7 degrees
/// apart: where functions of a direction are tabulated.
const std::vector<Eigen::Vector3d>& tableDirections();

/// A twice continuously differentiable partition of unity over tableDirections(), at one direction.
struct DirectionWeights {
  /// unit: a unit vector. Real time.
  explicit DirectionWeights(const Eigen::Vector3d& unit) noexcept;

  static constexpr std::size_t most = 32;
  std::size_t size = 0;                         ///< used entries of the arrays
  std::array<std::uint16_t, most> numbers;      ///< in tableDirections()
  std::array<double, most> weights;             ///< sum: 1
  std::array<Eigen::Vector3d, most> gradients;  ///< of the weights by the direction, tangential
};

/// Table directions that share a weight somewhere with direction `number`, itself among them.
const std::vector<std::size_t>& directionsBeside(std::size_t number);

}  // namespace palpate
