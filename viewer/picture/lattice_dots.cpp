#include "viewer/picture/lattice_dots.hpp"

#include <cmath>

#include "viewer/plot/viridis.hpp"

namespace palpate {
namespace {

/// Rounding must not drop the points of the plane half a spacing away on one side and keep the
/// other's.
constexpr double slack = 1 + 1e-9;

bool keeps(const std::optional<LatticeCut>& cut, const Eigen::Vector3d& displacement,
           double spacing) {
  return !cut || std::abs(displacement[cut->axis] - cut->offset) <= 0.5 * spacing * slack;
}

}  // namespace

std::array<double, 3> colourOf(Tag tag) {
  switch (tag) {
    case Tag::expandable:
      return {38, 140, 72};
    case Tag::terminating:
      return {235, 140, 20};
    case Tag::failed:
      return {205, 35, 45};
    case Tag::unknown:
      break;
  }
  return {130, 130, 138};
}

std::vector<LatticeDot> tagDots(const SpaceTable& space, const std::optional<LatticeCut>& cut) {
  std::vector<LatticeDot> dots;
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    const Eigen::Vector3d displacement = space.lattice.displacement(n);
    if (keeps(cut, displacement, space.lattice.spacing()))
      dots.push_back({displacement, colourOf(space.points[static_cast<std::size_t>(n)].tag)});
  }
  return dots;
}

std::vector<CellError> cellErrors(const SpaceTable& space, const ForceField& field) {
  const Lattice& lattice = space.lattice;
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5 * lattice.spacing());
  std::vector<CellError> errors;
  for (std::int32_t n = 0; n < lattice.uniformSize(); ++n) {
    const Eigen::Vector3d middle = lattice.displacement(n) + half;
    if (middle.norm() <= lattice.radius())
      errors.push_back({middle, field.evaluate(middle).error_bound});
  }
  return errors;
}

ErrorScale::ErrorScale(const std::vector<CellError>& errors) {
  double largest = 0;
  for (const CellError& cell : errors)
    if (std::isfinite(cell.error)) largest = std::max(largest, cell.error);
  if (largest > 0) highest = std::pow(10, std::ceil(std::log10(largest) - 1e-9));
  lowest = 1e-3 * highest;
}

double ErrorScale::place(double error) const {
  if (!(error > lowest)) return 0;
  return std::min(std::log10(error / lowest) / std::log10(highest / lowest), 1.0);
}

std::vector<LatticeDot> errorDots(const std::vector<CellError>& errors, const ErrorScale& scale,
                                  double spacing, const std::optional<LatticeCut>& cut) {
  std::vector<LatticeDot> dots;
  for (const CellError& cell : errors)
    if (std::isfinite(cell.error) && keeps(cut, cell.displacement, spacing))
      dots.push_back({cell.displacement, viridis(scale.place(cell.error))});
  return dots;
}

}  // namespace palpate
