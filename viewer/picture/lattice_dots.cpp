#include "viewer/picture/lattice_dots.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/assertion.hpp"
#include "viewer/plot/viridis.hpp"

namespace palpate {
namespace {

/// Allows for rounding: points exactly half a spacing away from the plane are shown, on both sides
/// of it.
constexpr double slack = 1 + 1e-9;

bool keeps(const std::optional<LatticeCut>& cut, const Eigen::Vector3d& displacement,
           double spacing) {
  return !cut || std::abs(displacement[cut->axis] - cut->offset) <= 0.5 * spacing * slack;
}

}  // namespace

std::array<double, 3> colourOf(Tag tag) {
  switch (tag) {
    case Tag::expandable: return {38, 140, 72};
    case Tag::terminating: return {235, 140, 20};
    case Tag::failed: return {205, 35, 45};
    case Tag::unknown: break;
  }
  return {130, 130, 138};
}

std::vector<LatticeDot> tagDots(const SpaceTable& space, const std::optional<LatticeCut>& cut) {
  PALPATE_ASSERT(std::ssize(space.points) == space.lattice.size(),
                 "each lattice point must have a record");
  std::vector<LatticeDot> dots;
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    const Eigen::Vector3d displacement = space.lattice.displacement(n);
    if (keeps(cut, displacement, space.lattice.spacing()))
      dots.push_back({displacement, colourOf(space.points[static_cast<std::size_t>(n)].tag)});
  }
  return dots;
}

double relativeError(double bound, double force) {
  return bound / std::max(force, relative_error_floor);
}

std::vector<CellError> cellErrors(const SpaceTable& space, const ForceField& field) {
  const Lattice& lattice = space.lattice;
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5 * lattice.spacing());
  std::vector<CellError> errors;
  for (std::int32_t n = 0; n < lattice.uniformSize(); ++n) {
    const Eigen::Vector3d middle = lattice.displacement(n) + half;
    if (middle.norm() > lattice.radius()) continue;
    const ForceSample sample = field.evaluate(middle);
    errors.push_back({middle, relativeError(sample.error_bound, sample.force.norm())});
  }
  return errors;
}

double errorPlace(double relative) {
  if (!(relative > lowest_error)) return 0;
  return std::min(std::log(relative / lowest_error) / std::log(highest_error / lowest_error), 1.0);
}

std::vector<LatticeDot> errorDots(const std::vector<CellError>& errors, double spacing,
                                  const std::optional<LatticeCut>& cut) {
  PALPATE_ASSERT(spacing > 0, "a lattice must have a spacing");
  std::vector<LatticeDot> dots;
  for (const CellError& cell : errors)
    if (std::isfinite(cell.relative) && keeps(cut, cell.displacement, spacing))
      dots.push_back({cell.displacement, viridis(errorPlace(cell.relative))});
  return dots;
}

}  // namespace palpate
