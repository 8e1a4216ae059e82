#include "viewer/fields/site_jets.hpp"

#include "common/base/assertion.hpp"
#include "viewer/fields/potential_field.hpp"

namespace palpate {
namespace {

void setQuantity(std::vector<SiteJet>& jets, Eigen::Index quantity,
                 const std::vector<EnergyJet>& values) {
  PALPATE_ASSERT(jets.size() == values.size(), "all quantities must be of the same cells");
  for (std::size_t s = 0; s < jets.size(); ++s)
    for (std::size_t n = 0; n < values[s].size(); ++n)
      jets[s](static_cast<Eigen::Index>(n), quantity) = static_cast<float>(values[s][n]);
}

/// Returns the index of a leaf's corner. local: a place in the leaf that is a corner.
std::size_t cornerAt(const Eigen::Vector3d& local) {
  return (local.x() > 0 ? 1 : 0) + (local.y() > 0 ? 2 : 0) + (local.z() > 0 ? 4 : 0);
}

}  // namespace

SiteJet jetInLeaf(const CellTree& tree, std::span<const SiteJet> jets, std::int32_t leaf,
                  const Eigen::Vector3d& local) {
  using Quantities = Eigen::Array<float, 1, place_quantities>;
  const AxisFactors factors = axisFactors(tree.edge(leaf), tree.spacing(), local);
  const auto numbers = jetInLeaf<float>(
      factors, Quantities(Quantities::Zero()), [&](std::size_t c, std::size_t n) -> Quantities {
        return jets[palpate::at(tree.corners(leaf)[c])].row(static_cast<Eigen::Index>(n)).array();
      });
  SiteJet jet = SiteJet::Zero();
  for (std::size_t n = 0; n < numbers.size(); ++n)
    jet.row(static_cast<Eigen::Index>(n)) = numbers[n].matrix();
  return jet;
}

LeafPlace SiteJets::placeOf(const LatticePoint& point) const {
  LeafPlace place;
  for (std::size_t octant = 0; place.leaf < 0 && octant < 8; ++octant)
    place = tree.leafBeside(point, octant);
  PALPATE_ASSERT(place.leaf >= 0, "the cells of a site must cover the ball of its area");
  return place;
}

SiteJet SiteJets::at(const LeafPlace& place) const {
  if (!isCorner(place.local)) return jetInLeaf(tree, jets, place.leaf, place.local);
  return jets[palpate::at(tree.corners(place.leaf)[cornerAt(place.local)])];
}

SiteJets::SiteJets(CellData data, const SpaceTable& space, SiteFits& fits)
    : tree(data.tree), region(data) {
  PALPATE_ASSERT(space.patch.finger, "only a finger has a force -dE/ds along the surface");
  jets.assign(tree.slots().size(), SiteJet::Zero());
  coverage.assign(data.support.begin(), data.support.end());
  const auto polynomials = correctedPolynomials(data, space, fits.energy);
  const std::vector<EnergyJet> energies = energyJets(tree, polynomials);
  p_error = FieldError(tree, polynomials, energies, data.suspect, data.has_fibers);
  setQuantity(jets, 0, energies);
  // `view` is the space with another quantity in place of the energy, so that the functions for
  // energies also interpolate that quantity. Points that are excluded from the interpolation of the
  // energy are excluded for every quantity.
  const std::vector<bool> interpolated = interpolatedPoints(space);
  SpaceTable view(space);
  for (std::size_t n = 0; n < interpolated.size(); ++n)
    view.points[n].tag = interpolated[n] ? Tag::expandable : Tag::failed;
  // Calls set(from, to) for each interpolated point: `from` is the solved equilibrium, and `set`
  // writes the quantity into `to`, which is empty.
  const auto jetsOf = [&](auto set, LocalFits& of_its_order) {
    for (std::size_t n = 0; n < interpolated.size(); ++n) {
      view.points[n].equilibrium = {};
      if (interpolated[n]) set(space.points[n].equilibrium, view.points[n].equilibrium);
    }
    auto ghosts = ghostPolynomials(tree, view, data.inconsistent, of_its_order);
    return slotJets(
        tree, slotPolynomials(tree, view, data.inconsistent, std::move(ghosts), of_its_order));
  };
  for (int axis = 0; axis < 3; ++axis) {
    const auto set = [axis](const Equilibrium& e, Equilibrium& drive) {
      drive.energy = e.drive[axis];
      drive.force = -e.drive_stiffness.row(axis);
      drive.stiffness = -symmetricOf(e.stiffness_by_s.col(axis));
    };
    setQuantity(jets, 1 + axis, jetsOf(set, fits.drive));
  }
  for (std::size_t c = 0; c < symmetric_axes.size(); ++c) {
    const auto set = [c](const Equilibrium& e, Equilibrium& slope) {
      slope.energy = e.drive_slope(symmetric_axes[c][0], symmetric_axes[c][1]);
      slope.force = -e.drive_slope_by_p.row(static_cast<Eigen::Index>(c));
    };
    setQuantity(jets, static_cast<Eigen::Index>(4 + c), jetsOf(set, fits.slope));
  }
  PALPATE_ASSERT(coverage.size() == jets.size(), "each corner must have a coverage and an energy");
  fillHanging(tree, jets, [&](std::int32_t leaf, const Eigen::Vector3d& local) {
    return jetInLeaf(tree, jets, leaf, local);
  });
}

}  // namespace palpate
