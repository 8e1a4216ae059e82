#pragma once

#include <limits>

#include "tests/support/touchable_body.hpp"

namespace palpate::test {

/// A TouchableBody with stored pressures. At rest the pressure is at_rest everywhere, as if from
/// weight. Under a tool the pressure grows with the depth and falls with the distance. Below the
/// height `linear_below`, the material is linear and has no pressure.
struct PressedBody : TouchableBody {
  static constexpr float at_rest = 30;  ///< Pa

  explicit PressedBody(const Mesh& mesh, const std::vector<Active>& active, double factor = 1,
                       double linear_below = -std::numeric_limits<double>::infinity());

  /// Pressure at a vertex while the active node of a space is displaced by p, Pa.
  float pressure(std::size_t space, const Eigen::Vector3d& p, std::int32_t vertex) const;
  NodalFields fields(std::size_t space, std::int32_t point) const;
  /// Throws if the file cannot be written.
  void seal(const std::filesystem::path& file) const;

 private:
  double factor_, linear_below_;
};

}  // namespace palpate::test
