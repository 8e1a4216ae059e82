#include "viewer/fields/direction_weights.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "viewer/fields/wendland.hpp"

namespace palpate {
namespace {

constexpr std::size_t table_size = 768;
/// Table directions within this chord length have a non-zero weight; there are about twelve.
constexpr double reach = 0.25;

std::vector<Eigen::Vector3d> fibonacciLattice() {
  std::vector<Eigen::Vector3d> directions;
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
  for (std::size_t n = 0; n < table_size; ++n) {
    const double number = static_cast<double>(n),
                 z = 1 - (2 * number + 1) / static_cast<double>(table_size),
                 across = std::sqrt(1 - z * z);
    directions.emplace_back(across * std::cos(turn * number), across * std::sin(turn * number), z);
  }
  return directions;
}

std::vector<std::vector<std::size_t>> allBeside() {
  const std::vector<Eigen::Vector3d>& directions = tableDirections();
  std::vector<std::vector<std::size_t>> beside(directions.size());
  for (std::size_t n = 0; n < directions.size(); ++n)
    for (std::size_t other = 0; other < directions.size(); ++other)
      if ((directions[n] - directions[other]).norm() < 2 * reach) beside[n].push_back(other);
  return beside;
}

}  // namespace

const std::vector<Eigen::Vector3d>& tableDirections() {
  static const std::vector<Eigen::Vector3d> directions = fibonacciLattice();
  return directions;
}

DirectionWeights::DirectionWeights(const Eigen::Vector3d& unit) noexcept {
  const std::vector<Eigen::Vector3d>& directions = tableDirections();
  double whole = 0;
  Eigen::Vector3d whole_gradient = Eigen::Vector3d::Zero();
  // Directions are sorted by z, and the ends of a chord no longer than `reach` differ in z by at
  // most `reach`. Only this range of the table is searched.
  const double middle = 0.5 * (1 - unit.z()) * table_size, around = 0.5 * reach * table_size + 1;
  const auto first = static_cast<std::size_t>(std::max(0.0, middle - around)),
             end = std::min(table_size, static_cast<std::size_t>(middle + around) + 1);
  for (std::size_t n = first; n < end && size < most; ++n) {
    const Eigen::Vector3d chord = unit - directions[n];
    const double squared = chord.squaredNorm();
    if (squared >= reach * reach) continue;
    const Wendland w(std::sqrt(squared) / reach);
    numbers[size] = static_cast<std::uint16_t>(n);
    weights[size] = w.value;
    gradients[size] = w.slope_over_x / (reach * reach) * (chord - chord.dot(unit) * unit);
    whole += weights[size];
    whole_gradient += gradients[size];
    ++size;
  }
  for (std::size_t n = 0; n < size; ++n) {
    weights[n] /= whole;
    gradients[n] = (gradients[n] - weights[n] * whole_gradient) / whole;
  }
}

const std::vector<std::size_t>& directionsBeside(std::size_t number) {
  static const std::vector<std::vector<std::size_t>> beside = allBeside();
  return beside[number];
}

}  // namespace palpate
