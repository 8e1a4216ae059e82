#pragma once

#include <limits>

#include "tests/support/touchable_body.hpp"

namespace palpate::test {

/// A TouchableBody that stores pressures, which a function says: what its weight gives at rest
/// everywhere, and under a tool more the deeper it presses, less with the distance from it. Below a
/// height its material is linear and has none.
struct PressedBody : TouchableBody {
  static constexpr float at_rest = 30;  ///< Pa

  explicit PressedBody(const Mesh& mesh, const std::vector<Active>& active, double factor = 1,
                       double linear_below = -std::numeric_limits<double>::infinity());

  /// Pa, of a vertex while the active node of a space is displaced by p.
  float pressure(std::size_t space, const Eigen::Vector3d& p, std::int32_t vertex) const;
  NodalFields fields(std::size_t space, std::int32_t point) const;
  /// Error when it cannot be written.
  void seal(const std::filesystem::path& file) const;

 private:
  double factor_, linear_below_;
};

}  // namespace palpate::test
