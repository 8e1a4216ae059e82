#include "viewer/fields/area_field.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/machine.hpp"
#include "common/base/parallel.hpp"
#include "viewer/fields/jet_sums.hpp"
#include "viewer/fields/wendland.hpp"

namespace palpate {
namespace {

/// Every place of the surface near a site has a collocation point within this distance, in finger
/// radii. The corresponding distance of sites is site_distance.
constexpr double collocation_distance = 0.3;
/// Reach of a collocation point, as a multiple of collocation_distance, and of a site, as a
/// multiple of site_distance. Even the farthest place then has two or three points within reach. A
/// smaller reach makes the blend steeper and the drive less accurate.
constexpr double reach_in_distances = 1.4;
/// Number of sites from which a collocation point is interpolated.
constexpr std::size_t sites_of_collocation_point = 7;
/// Width of the kernel, in finger radii. Between 1 and 2 the errors differ by less than a third.
constexpr double kernel_width = 1.5;
/// Factors of the three terms of an area's error bound:
/// - share_of_p_error multiplies the bound for interpolation in p at each site.
/// - share_of_order_difference multiplies the difference from the force of lower order in s.
/// - share_of_force is a constant relative error, for interpolation to collocation points.
///
/// docs/internals/thresholds.md explains how they were chosen.
constexpr double share_of_p_error = 0.6, share_of_order_difference = 2, share_of_force = 0.0035;
/// Preparing a site takes about as long as interpolating to this many collocation points.
constexpr std::size_t work_of_site = 16;
/// Largest number of levels of refinement (Accuracy::levels).
constexpr std::size_t most_levels = 6;

/// Returns the indices of the `count` points nearest to `place`, nearest first.
std::vector<std::size_t> nearestOf(const std::vector<Eigen::Vector3d>& points,
                                   const Eigen::Vector3d& place, std::size_t count) {
  std::vector<std::size_t> numbers = countUp<std::size_t>(points.size());
  count = std::min(count, numbers.size());
  std::ranges::partial_sort(
      numbers, numbers.begin() + static_cast<std::ptrdiff_t>(count), {},
      [&](std::size_t n) { return std::pair((points[n] - place).squaredNorm(), n); });
  numbers.resize(count);
  return numbers;
}

/// Returns whether a point is clearly beyond the reach. Saves the square root for most points.
bool isFar(const Eigen::Vector3d& offset, const NearPoints& points) noexcept {
  return offset.squaredNorm() > 1.001 * points.reach() * points.reach();
}

template <class Visit>
void eachWithin(const NearPoints& points, const Eigen::Vector3d& s, Visit visit) noexcept {
  for (const std::int32_t n : points.near(s))
    if ((s - points.points()[at(n)]).norm() < points.reach()) visit(at(n));
}

std::vector<std::size_t> withinReach(const NearPoints& points, const Eigen::Vector3d& s) {
  std::vector<std::size_t> found;
  eachWithin(points, s, [&](std::size_t n) { found.push_back(n); });
  return found;
}

/// Interpolates the quantities at a place from its nearest sites.
class Interpolation {
 public:
  Interpolation(const std::vector<Eigen::Vector3d>& sites, std::vector<std::size_t> used,
                const Eigen::Vector3d& place, double width)
      : from(std::move(used)) {
    const auto center = [&](std::size_t site) { return sites[site]; };
    weights_ = hermiteWeights(place, mapped(from, center), width);
  }

  /// Interpolates the quantities at a lattice point to `jet`, and
  /// HermiteWeights::order_difference to `difference`.
  void at(const std::vector<std::optional<SiteJets>>& made, const LatticePoint& point, SiteJet& jet,
          QuantityJet& difference) const {
    jet.setZero();
    difference.setZero();
    for (std::size_t n = 0; n < from.size(); ++n) {
      const auto column = place_quantities * static_cast<Eigen::Index>(n);
      const Eigen::Matrix<float, place_quantities, place_quantities> block =
          weights_.coefficients.middleCols<place_quantities>(column);
      const SiteJets& site = *made[from[n]];
      const SiteJet of_site = site.at(site.placeOf(point));
      jet += of_site.lazyProduct(block.transpose());
      difference += of_site.lazyProduct(
          weights_.order_difference.segment<place_quantities>(column).transpose());
    }
  }

  const std::vector<std::size_t> from;

 private:
  HermiteWeights weights_;
};

/// Returns the factors of the ten quantities in Q(d) = E - T . d - d . (dT/ds) d / 2.
JetSums::Quantities expansionAt(const Eigen::Vector3f& d) noexcept {
  JetSums::Quantities factors;
  factors << 1, -d, JetSums::Quantities::Zero().tail<6>();
  for (std::size_t c = 0; c < symmetric_axes.size(); ++c) {
    const auto [a, b] = symmetric_axes[c];
    factors[static_cast<Eigen::Index>(4 + c)] = -(a == b ? 0.5f : 1.0f) * d[a] * d[b];
  }
  return factors;
}

/// Returns dQ/dd = -T - (dT/ds) d.
Eigen::Vector3f slopeAt(const Eigen::Vector3f& d, const JetSums::Quantities& quantities) noexcept {
  Eigen::Vector3f slope = -quantities.segment<3>(1);
  for (std::size_t c = 0; c < symmetric_axes.size(); ++c) {
    const auto [a, b] = symmetric_axes[c];
    const float quantity = quantities[static_cast<Eigen::Index>(4 + c)];
    slope[a] -= quantity * d[b];
    if (a != b) slope[b] -= quantity * d[a];
  }
  return slope;
}

/// Evaluates the polynomial of a leaf with these jets at its corners.
EnergySample energyIn(const std::array<EnergyJet, 8>& jets, double edge, double spacing,
                      const Eigen::Vector3d& local) noexcept {
  LeafJets leaf;
  for (std::size_t c = 0; c < 8; ++c) leaf[c] = &jets[c];
  return evaluateEnergy(leaf, edge, spacing, local);
}

}  // namespace

struct AreaField::LevelSum {
  bool begun = false;
  double edge = 0;
  Eigen::Vector3d local;
  JetSums sums;  ///< sums of w Q, a polynomial that is E times the sum of w

  void begin(double leaf_edge, double spacing, const Eigen::Vector3d& place) noexcept {
    begun = true;
    edge = leaf_edge;
    local = place;
    sums.begin(valueBasis(edge, spacing, local));
  }

  /// Divides the sums by `whole`, the sum of all weights, and adds the energy and its derivatives
  /// to a sample.
  void addTo(AreaSample& sample, double whole, double spacing) const noexcept {
    std::array<EnergyJet, 8> jets;
    sums.divide(whole, jets);
    const EnergySample energy = energyIn(jets, edge, spacing, local);
    sample.energy += energy.energy;
    sample.force += energy.force;
    sample.stiffness += energy.stiffness;
  }
};

std::vector<const SpaceTable*> chosenOf(const std::vector<SpaceTable>& spaces,
                                        const std::vector<std::size_t>& chosen) {
  return mapped(chosen, [&](std::size_t space) { return &spaces.at(space); });
}

std::vector<Eigen::Vector3d> centersOf(const std::vector<const SpaceTable*>& sites) {
  return mapped(sites, [](const SpaceTable* site) { return site->patch.finger.value().center; });
}

AreaField::AreaField(std::vector<const SpaceTable*> sites, CollocationPoints collocation_points)
    : spaces_(std::move(sites)),
      radius_(spaces_.at(0)->lattice.radius()),
      finger_(spaces_.front()->patch.finger.value().radius),
      sites_(centersOf(spaces_), reach_in_distances * site_distance * finger_),
      collocation_points_(std::move(collocation_points.places),
                          reach_in_distances * collocation_distance * finger_),
      at_collocation_points_(collocationPointCount()),
      judgements_(siteCount()),
      made_(siteCount()) {
  const auto isTooFine = [](const LatticeCell& cell) { return at(cell.level) >= most_levels; };
  for (const SpaceTable* space : spaces_) {
    PALPATE_ASSERT(space->lattice.radius() == radius_ &&
                       space->lattice.spacing() == spaces_.front()->lattice.spacing(),
                   "all sites of an area must have the same lattice");
    if (std::ranges::any_of(space->splits, isTooFine))
      throw badInput(
          "a lattice has cells split more than {} times, which no build makes: the file is "
          "damaged; copy it again",
          most_levels);
  }
}

AreaField::AreaField(const std::vector<const SpaceTable*>& sites,
                     const std::vector<Eigen::Vector3d>& surface,
                     const std::function<void(double)>& progress)
    : AreaField(sites, collocationPointsOf(sites, surface)) {
  prepareAll(progress);
}

/// Spreads the points evenly over the part of the surface that is near sites.
AreaField::CollocationPoints AreaField::collocationPointsOf(
    const std::vector<const SpaceTable*>& sites, const std::vector<Eigen::Vector3d>& surface) {
  const double finger = sites.at(0)->patch.finger.value().radius;
  std::vector<Eigen::Vector3d> places = centersOf(sites);
  const NearPoints centers(places, answered_distance * finger);
  for (const Eigen::Vector3d& place : surface)
    if (centers.isReached(place)) places.push_back(place);
  const auto any = [](const Eigen::Vector3d&, std::size_t) { return true; };
  const std::vector<double> distances(places.size(), collocation_distance * finger);
  return {farthestPoints(places, distances, any)};
}

void AreaField::prepareAll(const std::function<void(double)>& progress) {
  std::atomic<std::size_t> work_done = 0;
  const std::size_t work = work_of_site * siteCount() + collocationPointCount();
  const auto did = [&](std::size_t more) {
    const std::size_t done = work_done += more;
    if (progress) progress(static_cast<double>(done) / static_cast<double>(work));
  };
  prepare(countUp<std::size_t>(collocationPointCount()), countUp<std::size_t>(siteCount()), did);
  PALPATE_ASSERT(made_count_ == siteCount(), "sites must be prepared before errors are estimated");
  is_whole_ = true;
  fits_ = {};
  made_ = {};
}

void AreaField::prepareAt(const Eigen::Vector3d& s) {
  prepare(withinReach(collocation_points_, s), sitesAt(s), [](std::size_t) {});
}

void AreaField::prepare(const std::vector<std::size_t>& collocation_points,
                        const std::vector<std::size_t>& judged,
                        const std::function<void(std::size_t)>& did) {
  std::vector<std::size_t> new_collocation_points, new_judged;
  std::set<std::size_t> sites;
  const auto need = [&](const std::vector<std::size_t>& needed) {
    for (const std::size_t site : needed)
      if (!made_[site]) sites.insert(site);
  };
  for (const std::size_t collocation_point : collocation_points) {
    if (isInterpolated(collocation_point)) continue;
    new_collocation_points.push_back(collocation_point);
    need(sitesOfCollocationPoint(collocation_point));
  }
  for (const std::size_t site : judged) {
    if (isJudged(site)) continue;
    new_judged.push_back(site);
    need({site});
  }
  if (new_collocation_points.empty() && new_judged.empty()) return;
  const std::vector<std::size_t> new_sites(sites.begin(), sites.end());
  const std::size_t n_parts = coreCount();
  while (fits_.size() < n_parts) fits_.emplace_back(spaces_.front()->lattice.unit());
  inParallel(std::min(n_parts, new_sites.size()), [&](std::size_t part) {
    for (std::size_t n = part; n < new_sites.size(); n += n_parts) {
      made_[new_sites[n]].emplace(*spaces_[new_sites[n]], fits_[part]);
      did(work_of_site);
    }
  });
  made_count_ += new_sites.size();
  for (const std::size_t collocation_point : new_collocation_points)
    beginCollocationPoint(collocation_point);
  inParallel(new_collocation_points.size(), [&](std::size_t n) {
    interpolateTo(new_collocation_points[n]);
    did(1);
  });
  for (const std::size_t site : new_judged) keep(site);
}

bool AreaField::makeOneOf(const std::vector<std::size_t>& sites) {
  const auto lacking = std::find_if(sites.begin(), sites.end(),
                                    [&](std::size_t site) { return !made_[site].has_value(); });
  if (lacking == sites.end()) return false;
  if (fits_.empty()) fits_.emplace_back(spaces_.front()->lattice.unit());
  made_[*lacking].emplace(*spaces_[*lacking], fits_.front());
  ++made_count_;
  return true;
}

bool AreaField::prepareNext(const Eigen::Vector3d& s) {
  for (const std::size_t collocation_point : withinReach(collocation_points_, s)) {
    if (isInterpolated(collocation_point)) continue;
    if (makeOneOf(sitesOfCollocationPoint(collocation_point))) return true;
    beginCollocationPoint(collocation_point);
    interpolateTo(collocation_point);
    return true;
  }
  for (const std::size_t site : sitesAt(s)) {
    if (isJudged(site)) continue;
    if (makeOneOf({site})) return true;
    keep(site);
    return true;
  }
  return false;
}

bool AreaField::prepareSite(const Eigen::Vector3d& s) {
  return made_count_ < siteCount() && makeOneOf(nearestOf(sites_.points(), s, siteCount()));
}

std::size_t AreaField::treeOf(const SpaceTable& like, const std::vector<LatticeCell>& splits) {
  const auto [known, is_new] = tree_of_splits_.try_emplace(splits, trees_.size());
  if (is_new) {
    SpaceTable table;
    table.lattice = like.lattice;
    table.points.resize(like.points.size());
    table.points.front().tag = Tag::expandable;
    table.splits = splits;
    trees_.emplace_back(table);
  }
  return known->second;
}

std::vector<std::size_t> AreaField::sitesAt(const Eigen::Vector3d& s) const {
  return withinReach(sites_, s);
}

bool AreaField::isPreparedAt(const Eigen::Vector3d& s) const noexcept {
  bool is_prepared = true;
  eachWithin(collocation_points_, s,
             [&](std::size_t n) { is_prepared = is_prepared && isInterpolated(n); });
  eachWithin(sites_, s, [&](std::size_t n) { is_prepared = is_prepared && isJudged(n); });
  return is_prepared;
}

std::vector<std::size_t> AreaField::sitesOfCollocationPoint(std::size_t collocation_point) const {
  return nearestOf(sites_.points(), collocation_points_.points()[collocation_point],
                   sites_of_collocation_point);
}

std::vector<Eigen::Vector3d> AreaField::collocationPointsFrom(
    const std::vector<bool>& sites) const {
  std::vector<Eigen::Vector3d> places;
  for (std::size_t n = 0; n < collocationPointCount(); ++n)
    if (std::ranges::any_of(sitesOfCollocationPoint(n), [&](std::size_t s) { return sites[s]; }))
      places.push_back(collocation_points_.points()[n]);
  return places;
}

void AreaField::beginCollocationPoint(std::size_t collocation_point) {
  std::set<LatticeCell> cells;
  for (const std::size_t site : sitesOfCollocationPoint(collocation_point))
    cells.insert(spaces_[site]->splits.begin(), spaces_[site]->splits.end());
  std::vector<LatticeCell> splits(cells.begin(), cells.end());
  std::ranges::sort(splits, coarserFirst);
  at_collocation_points_[collocation_point].tree = treeOf(*spaces_.front(), splits);
}

void AreaField::interpolateTo(std::size_t collocation_point) {
  PALPATE_ASSERT(std::ranges::all_of(sitesOfCollocationPoint(collocation_point),
                                     [&](std::size_t site) { return made_[site].has_value(); }),
                 "the sites must be prepared before the collocation point");
  const CellTree& tree = trees_[at_collocation_points_[collocation_point].tree];
  std::vector<SiteJet> jets(tree.slots().size());
  std::vector<QuantityJet>& differences =
      at_collocation_points_[collocation_point].order_differences;
  differences.resize(jets.size());
  const Interpolation interpolation(sites_.points(), sitesOfCollocationPoint(collocation_point),
                                    collocation_points_.points()[collocation_point],
                                    kernel_width * finger_);
  // The jets of hanging slots are replaced below.
  for (std::size_t slot = 0; slot < jets.size(); ++slot)
    interpolation.at(made_, tree.slots()[slot].point, jets[slot], differences[slot]);
  fillHanging(tree, jets, [&](std::int32_t leaf, const Eigen::Vector3d& local) {
    return jetInLeaf(tree, jets, leaf, local);
  });
  at_collocation_points_[collocation_point].jets =
      mapped(jets, [](const SiteJet& jet) { return PackedJet(jet); });
}

void AreaField::keep(std::size_t site) {
  PALPATE_ASSERT(made_[site].has_value(), "a site must be prepared before its estimates are kept");
  judgements_[site] = {.tree = treeOf(*spaces_[site], spaces_[site]->splits),
                       .coverage = made_[site]->coverage,
                       .p_error = made_[site]->p_error,
                       .region = made_[site]->region};
}

struct AreaField::NearCollocationPoint {
  const CollocationPoint* collocation_point;
  Eigen::Vector3d offset;  ///< m, from the collocation point to the place
  double weight;
  Eigen::Vector3d weight_slope;  ///< 1/m
  const CellTree* tree;
  LeafPlace place;  ///< leaf that contains the displacement
  bool is_new_tree;

  std::array<const PackedJet*, 8> jets() const noexcept {
    const LeafCorners& slots = tree->corners(place.leaf);
    std::array<const PackedJet*, 8> found;
    for (std::size_t c = 0; c < 8; ++c) found[c] = &collocation_point->jets[at(slots[c])];
    return found;
  }
};

template <class Visit>
void AreaField::eachCollocationPoint(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                                     Visit visit) const noexcept {
  NearCollocationPoint near{};
  for (const std::int32_t number : collocation_points_.near(s)) {
    near.offset = s - collocation_points_.points()[at(number)];
    if (isFar(near.offset, collocation_points_)) continue;
    const double x = near.offset.norm() / collocation_points_.reach();
    if (!(x < 1)) continue;
    near.collocation_point = &at_collocation_points_[at(number)];
    // Neighbouring collocation points often share a tree; only a new tree must be searched.
    const CellTree* const tree = &trees_[near.collocation_point->tree];
    near.is_new_tree = near.tree != tree;
    if (near.is_new_tree) {
      near.tree = tree;
      near.place = tree->find(p);
      if (near.place.leaf < 0) return;
    }
    const Wendland w(x);
    near.weight = w.value;
    near.weight_slope =
        w.slope_over_x / (collocation_points_.reach() * collocation_points_.reach()) * near.offset;
    visit(near);
  }
}

template <class Visit>
void AreaField::eachSite(const Eigen::Vector3d& s, Visit visit) const noexcept {
  for (const std::int32_t site : sites_.near(s)) {
    const Eigen::Vector3d offset = s - sites_.points()[at(site)];
    if (isFar(offset, sites_)) continue;
    const double x = offset.norm() / sites_.reach();
    if (!(x < 1)) continue;
    const Wendland w(x);
    visit(judgements_[at(site)], w.value,
          Eigen::Vector3d(w.slope_over_x / (sites_.reach() * sites_.reach()) * offset));
  }
}

AreaSample AreaField::evaluate(const Eigen::Vector3d& s,
                               const Eigen::Vector3d& displacement) const noexcept {
  AreaSample sample = evaluateUnjudged(s, displacement);
  judge(s, displacement, sample);
  return sample;
}

AreaSample AreaField::evaluateUnjudged(const Eigen::Vector3d& s,
                                       const Eigen::Vector3d& displacement) const noexcept {
  if (!s.allFinite() || (!is_whole_ && !isPreparedAt(s))) return {};
  return answerTo(
      displacement, radius_, leastRadiusAt(s),
      [&](const Eigen::Vector3d& unit) { return edgeAt(s, unit); },
      [&](const Eigen::Vector3d& p) { return inRegion(s, p); },
      [&](const PlacedEdge& edge, const Eigen::Vector3d& unit, double depth) {
        return beyondRegion(s, edge, unit, depth);
      });
}

double AreaField::leastRadiusAt(const Eigen::Vector3d& s) const noexcept {
  double least = radius_;
  eachSite(s, [&](const Judgement& judgement, double, const Eigen::Vector3d&) {
    least = std::min(least, judgement.region.leastRadius());
  });
  return least;
}

/// Returns the weighted mean of the edges of all sites within reach of s.
AreaField::PlacedEdge AreaField::edgeAt(const Eigen::Vector3d& s,
                                        const Eigen::Vector3d& unit) const noexcept {
  const DirectionWeights direction(unit);
  PlacedEdge edge;
  double whole = 0;
  Eigen::Vector3d whole_slope = Eigen::Vector3d::Zero();
  eachSite(s, [&](const Judgement& judgement, double weight, const Eigen::Vector3d& slope) {
    const RegionEdge of_site = judgement.region.along(direction);
    edge.add(weight, of_site);
    edge.radius_by_s += of_site.radius * slope;
    edge.stiffness_by_s += of_site.stiffness * slope;
    whole += weight;
    whole_slope += slope;
  });
  if (whole < std::numeric_limits<double>::min()) return {};
  PlacedEdge mean;
  mean.add(1 / whole, edge);
  mean.radius_by_s = (edge.radius_by_s - mean.radius * whole_slope) / whole;
  mean.stiffness_by_s = (edge.stiffness_by_s - mean.stiffness * whole_slope) / whole;
  return mean;
}

AreaSample AreaField::beyondRegion(const Eigen::Vector3d& s, const PlacedEdge& edge,
                                   const Eigen::Vector3d& unit, double depth) const noexcept {
  if (edge.radius <= 0) return {};
  AreaSample sample = inRegion(s, edge.radius * unit);
  judge(s, edge.radius * unit, sample);
  const double slope = -unit.dot(sample.force), curvature = -unit.dot(sample.stiffness * unit);
  // Adds -d/ds of the energy in continuedBeyond. Radius and stiffness of the edge depend on s too.
  sample.drive += depth * driveSlope(s, edge.radius * unit, unit, slope) -
                  depth * (curvature - edge.stiffness) * edge.radius_by_s -
                  0.5 * depth * depth * edge.stiffness_by_s;
  static_cast<ForceSample&>(sample) = continuedBeyond(sample, edge, unit, depth);
  return sample;
}

AreaSample AreaField::inRegion(const Eigen::Vector3d& s, const Eigen::Vector3d& p) const noexcept {
  std::array<LevelSum, most_levels + 1> levels;
  LevelSum* level = nullptr;
  double spacing = 0, whole = 0;
  Eigen::Vector3d whole_slope = Eigen::Vector3d::Zero(), slope = Eigen::Vector3d::Zero();
  eachCollocationPoint(s, p, [&](const NearCollocationPoint& near) {
    if (near.is_new_tree) {
      spacing = near.tree->spacing();  // all trees have the same spacing
      level = &levels[at(near.tree->leaves()[at(near.place.leaf)].level)];
      if (!level->begun) level->begin(near.tree->edge(near.place.leaf), spacing, near.place.local);
    }
    const Eigen::Vector3f offset = near.offset.cast<float>();
    const JetSums::Quantities factors = expansionAt(offset);
    const JetSums::Quantities values =
        level->sums.add(near.jets(), static_cast<float>(near.weight) * factors);
    whole += near.weight;
    whole_slope += near.weight_slope;
    slope += static_cast<double>(factors.dot(values)) * near.weight_slope +
             near.weight * slopeAt(offset, values).cast<double>();
  });
  if (whole < std::numeric_limits<double>::min()) return {};
  AreaSample sample;
  sample.energy = 0;
  for (const LevelSum& sum : levels)
    if (sum.begun) sum.addTo(sample, whole, spacing);
  // This is -d/ds of the quotient E = sum of w Q / sum of w.
  sample.drive = (sample.energy * whole_slope - slope) / whole;
  sample.is_judged = false;
  return sample;
}

/// Returns the derivative of the drive with respect to the displacement along a direction, N/m.
/// energy_slope: dE/dp along the direction. Computes the same sums as inRegion(), but with
/// derivatives along the direction in place of values.
Eigen::Vector3d AreaField::driveSlope(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                                      const Eigen::Vector3d& direction,
                                      double energy_slope) const noexcept {
  JetSums sums;
  double whole = 0;
  Eigen::Vector3d whole_slope = Eigen::Vector3d::Zero(), slope = Eigen::Vector3d::Zero();
  eachCollocationPoint(s, p, [&](const NearCollocationPoint& near) {
    if (near.is_new_tree)
      sums.begin(slopeBasis(near.tree->edge(near.place.leaf), near.tree->spacing(),
                            near.place.local, direction));
    const Eigen::Vector3f offset = near.offset.cast<float>();
    const JetSums::Quantities slopes = sums.add(near.jets(), JetSums::Quantities::Zero());
    whole += near.weight;
    whole_slope += near.weight_slope;
    slope += static_cast<double>(expansionAt(offset).dot(slopes)) * near.weight_slope +
             near.weight * slopeAt(offset, slopes).cast<double>();
  });
  if (whole < std::numeric_limits<double>::min()) return Eigen::Vector3d::Zero();
  return (energy_slope * whole_slope - slope) / whole;
}

/// Returns the difference from the force of lower order in s, N. The loop is that of inRegion().
double AreaField::orderDifference(const Eigen::Vector3d& s,
                                  const Eigen::Vector3d& p) const noexcept {
  struct Level {
    double edge = 0;  ///< m; 0: no leaf has this level
    Eigen::Vector3d local;
    std::array<QuantityJet, 8> sums;  ///< of w times the order differences at the corners
  };
  std::array<Level, most_levels + 1> levels;
  Level* level = nullptr;
  double spacing = 0, whole = 0;
  eachCollocationPoint(s, p, [&](const NearCollocationPoint& near) {
    if (near.is_new_tree) {
      spacing = near.tree->spacing();
      level = &levels[at(near.tree->leaves()[at(near.place.leaf)].level)];
      if (level->edge == 0) level->sums.fill(QuantityJet::Zero());
      level->edge = near.tree->edge(near.place.leaf);
      level->local = near.place.local;
    }
    whole += near.weight;
    const LeafCorners& slots = near.tree->corners(near.place.leaf);
    for (std::size_t c = 0; c < 8; ++c)
      level->sums[c] +=
          static_cast<float>(near.weight) * near.collocation_point->order_differences[at(slots[c])];
  });
  Eigen::Vector3d difference = Eigen::Vector3d::Zero();
  for (const Level& one : levels) {
    if (one.edge == 0) continue;
    std::array<EnergyJet, 8> jets;
    for (std::size_t c = 0; c < 8; ++c)
      for (std::size_t n = 0; n < jets[c].size(); ++n)
        jets[c][n] = static_cast<double>(one.sums[c][static_cast<Eigen::Index>(n)]);
    difference += energyIn(jets, one.edge, spacing, one.local).force;
  }
  return difference.norm() / whole;
}

void AreaField::judge(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                      AreaSample& sample) const noexcept {
  if (std::exchange(sample.is_judged, true)) return;
  double whole = 0, error = 0, coverage = 0;
  eachSite(s, [&](const Judgement& judgement, double weight, const Eigen::Vector3d&) {
    whole += weight;
    const CellTree& tree = trees_[judgement.tree];
    const LeafPlace place = tree.find(p);
    const LeafCorners& slots = tree.corners(place.leaf);
    const std::array<double, 8> weights = trilinearWeights(place.local);
    error += weight * judgement.p_error.bound(place.leaf, place.local);
    double covered = 0;
    for (std::size_t c = 0; c < 8; ++c)
      covered += weights[c] * static_cast<double>(judgement.coverage[at(slots[c])]);
    // Rounded to float, so that the coverage is exactly 1 if all corners are solved.
    coverage += weight * static_cast<double>(static_cast<float>(covered));
  });
  if (whole < std::numeric_limits<double>::min()) return;
  sample.error_bound = share_of_p_error * error / whole +
                       share_of_order_difference * orderDifference(s, p) +
                       share_of_force * sample.force.norm();
  sample.coverage = std::clamp(coverage / whole, 0.0, 1.0);
  sample.inside = sample.coverage > 0;
}

}  // namespace palpate
