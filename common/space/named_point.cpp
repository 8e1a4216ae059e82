#include "common/space/named_point.hpp"

#include <cmath>

#include "common/base/error.hpp"
#include "common/base/number_text.hpp"

namespace palpate {

std::int32_t pointNamed(const Lattice& lattice, const Eigen::Vector3d& in_spacings) {
  const Eigen::Array3d coordinates = lattice.divisions() * in_spacings;
  if ((coordinates.abs() < 1e9).all() && (coordinates == coordinates.round()).all()) {
    const Eigen::Array3i point = coordinates.cast<std::int32_t>();
    if (const auto number = lattice.indexOf({point[0], point[1], point[2]})) return *number;
  }
  throw badInput(
      "({}) is not in the lattice: "
      "it holds the points with i^2 + j^2 + k^2 <= {:.6g} (radius {} m / spacing {} m, "
      "squared){}",
      vectorText(in_spacings, 6), std::pow(lattice.radius() / lattice.spacing(), 2),
      lattice.radius(), lattice.spacing(),
      lattice.size() > lattice.uniformSize()
          ? fmt::format(", and {} refined ones", lattice.size() - lattice.uniformSize())
          : "");
}

}  // namespace palpate
