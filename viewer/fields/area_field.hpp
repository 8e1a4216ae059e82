#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "common/base/assertion.hpp"
#include "common/mesh/near_points.hpp"
#include "viewer/fields/cell_data.hpp"
#include "viewer/fields/force_field.hpp"
#include "viewer/fields/jet_sums.hpp"
#include "viewer/fields/site_jets.hpp"

namespace palpate {

/// Sample of an area's energy for a finger at s with the displacement p.
struct AreaSample : ForceSample {
  /// T = -dE/ds, N. Only its part tangential to the surface moves the finger.
  Eigen::Vector3d drive = Eigen::Vector3d::Zero();
  bool is_judged = true;  ///< false until AreaField::judge() has set what evaluateUnjudged() omits
};

/// Returns pointers to the elements of `spaces` with the indices in `chosen`. `spaces` must outlive
/// the pointers.
std::vector<const SpaceTable*> chosenOf(const std::vector<SpaceTable>& spaces,
                                        const std::vector<std::size_t>& chosen);
/// Centres of the fingers of these spaces, metres.
std::vector<Eigen::Vector3d> centersOf(const std::vector<const SpaceTable*>& sites);

/// Energy E(s, p) of a finger over an area, as a function of its place s and its displacement p.
/// The force is -dE/dp, the configurational force (drive) is -dE/ds. The work around every closed
/// loop in (s, p) is therefore zero, also if the loop leads from one site to others.
///
/// At each site and each solved p, the derivatives of E with respect to s and p are known exactly
/// to the third order, and those with respect to s alone to the second. Third derivatives are used
/// only where LocalFits::judge trusts them.
/// - In p, ten quantities (E, its gradient and its Hessian in s) are interpolated on the lattice of
///   each site, which may be refined (site_jets.hpp).
/// - In s, the quantities are interpolated from the sites to *collocation points*, places that lie
///   closer together than the sites. The kernel interpolant reproduces E at each of the seven
///   nearest sites exactly, and its gradient and Hessian approximately (hermite_kernel.hpp). Few
///   sites suffice, because the error falls with about the fifth power of the distance between
///   sites. The lattice of a collocation point is refined wherever one of the lattices of its seven
///   sites is refined.
/// - Around a collocation point, E is expanded to the second order in s. The expansions Q are
///   blended by a partition of unity (Shepard 1968). Let d be the vector from the collocation point
///   to s. Then
///
///     E(s, p) = sum of w(|d| / reach) Q(d, p) / sum of w,    w(x) = (1 - x)^4 (4 x + 1)
///
///   (Wendland 1995). The blend is smooth in space: the sites are not triangulated, the force jumps
///   at no edge, and thin lobes, rims or several bodies need no special treatment.
///
/// E is twice continuously differentiable in s and in p.
///
/// The error bound is a sum of three terms with measured factors (area_field.cpp): the bound for
/// interpolation in p; the difference from the force of an interpolant of lower order in s
/// (HermiteWeights::order_difference); and a constant share of the force.
///
/// The field can be prepared as a whole or only around a place. Web pages, which must not make the
/// reader wait, and commands that query few places prepare only around a place. Both give exactly
/// the same samples.
///
/// Only one thread at a time may prepare, and no thread may evaluate meanwhile. Any number of
/// threads may evaluate at the same time.
class AreaField {
 public:
  /// Collocation points, metres.
  struct CollocationPoints {
    std::vector<Eigen::Vector3d> places;
  };
  /// Prepares nothing yet. `sites`: spaces of one build, with fingers of the same radius; they must
  /// outlive the preparation. `collocation_points`: all collocation points of the area, at least
  /// one. Error if a site has cells that are split more often than a build can split them.
  AreaField(std::vector<const SpaceTable*> sites, CollocationPoints collocation_points);
  /// Prepares everything and calls `progress`, as prepareAll() does. `surface`: as in
  /// collocationPointsOf().
  AreaField(const std::vector<const SpaceTable*>& sites,
            const std::vector<Eigen::Vector3d>& surface,
            const std::function<void(double)>& progress = {});
  /// Returns the collocation points of an area. `surface`: places on the body's surface around the
  /// sites, much closer together than the finger's radius, metres (placesAround in
  /// common/problem/sites.hpp). Fast.
  static CollocationPoints collocationPointsOf(const std::vector<const SpaceTable*>& sites,
                                               const std::vector<Eigen::Vector3d>& surface);

  /// Prepares everything, in parallel on all cores. Any of the threads may call `progress` with the
  /// share of the work done, up to 1; an exception thrown by `progress` ends the preparation. Error
  /// if a site has no solved point. The sites' spaces are no longer read after the return.
  void prepareAll(const std::function<void(double)>& progress = {});
  /// Prepares everything that evaluate() needs at s (metres), in parallel on all cores. Errors as
  /// in prepareAll().
  void prepareAt(const Eigen::Vector3d& s);
  /// Does one step of prepareAt(), a few milliseconds of work. Returns false if nothing is left to
  /// do at s. Errors as in prepareAll().
  bool prepareNext(const Eigen::Vector3d& s);
  /// Prepares the site nearest to s that is not prepared yet. Returns false if all sites are
  /// prepared. Preparing the sites is most of the work; later steps of prepareNext() are fast.
  bool prepareSite(const Eigen::Vector3d& s);

  /// Evaluates the energy at any s and p. s: metres, place on the surface at rest; p: displacement,
  /// metres.
  ///
  /// - Beyond the answered region around s, the sample is extrapolated (continuedBeyond() in
  ///   answered_region.hpp). One energy E(s, p) covers both sides of the edge of the region.
  /// - If no site is within reach of s, the sample is not inside. If no collocation point is within
  ///   reach either, the sample is zero.
  /// - If s is not prepared, the sample is not inside and has no force.
  ///
  /// Real time.
  AreaSample evaluate(const Eigen::Vector3d& s, const Eigen::Vector3d& p) const noexcept;
  /// The same in two parts, for callers that need the error bound of few samples. The first leaves
  /// error_bound, coverage and `inside` to judge(), which is called with the same s and p.
  AreaSample evaluateUnjudged(const Eigen::Vector3d& s, const Eigen::Vector3d& p) const noexcept;
  void judge(const Eigen::Vector3d& s, const Eigen::Vector3d& p, AreaSample& sample) const noexcept;

  std::size_t siteCount() const { return sites_.points().size(); }
  std::size_t madeSites() const { return made_count_; }
  std::size_t collocationPointCount() const { return collocation_points_.points().size(); }
  /// Returns the collocation points that are interpolated from one of these sites, metres. sites:
  /// whether each site is one of them.
  std::vector<Eigen::Vector3d> collocationPointsFrom(const std::vector<bool>& sites) const;
  /// distance at which the influence of a collocation point ends, m
  double collocationReach() const { return collocation_points_.reach(); }
  /// distance at which the influence of a site ends, m
  double siteReach() const { return sites_.reach(); }
  /// Returns the indices of the sites within reach of a place, metres.
  std::vector<std::size_t> sitesAt(const Eigen::Vector3d& s) const;
  const Eigen::Vector3d& siteCenter(std::size_t site) const { return sites_.points()[site]; }

 private:
  /// A collocation point: its lattice and the quantities interpolated to it.
  struct CollocationPoint {
    std::size_t tree = 0;
    std::vector<PackedJet> jets;                 ///< per slot of the tree
    std::vector<QuantityJet> order_differences;  ///< per slot (HermiteWeights)
  };
  /// Error estimates and answered region of one site.
  struct Judgement {
    std::size_t tree = 0;
    std::vector<float> coverage;  ///< per slot of the tree, as ForceSample::coverage
    FieldError p_error;           ///< error of interpolation in p, in the tree's leaves
    AnsweredRegion region;
  };
  /// Edge of the answered region at a place, along one direction.
  struct PlacedEdge : RegionEdge {
    /// m/m and N/m per m, derivatives with respect to the place s.
    Eigen::Vector3d radius_by_s = Eigen::Vector3d::Zero(), stiffness_by_s = Eigen::Vector3d::Zero();
  };
  /// A collocation point within reach of a place, with the leaf of its tree that contains a
  /// displacement.
  struct NearCollocationPoint;
  /// Sums over the collocation points whose leaf around a displacement has the same level. Such
  /// leaves coincide, so their polynomials can be added.
  struct LevelSum;

  /// Returns the indices of the sites from which a collocation point is computed.
  std::vector<std::size_t> sitesOfCollocationPoint(std::size_t collocation_point) const;
  bool isInterpolated(std::size_t collocation_point) const {
    return !at_collocation_points_[collocation_point].jets.empty();
  }
  bool isJudged(std::size_t site) const { return !judgements_[site].coverage.empty(); }
  bool isPreparedAt(const Eigen::Vector3d& s) const noexcept;

  /// Interpolates to these collocation points and judges these sites, unless that is done already.
  /// First prepares the sites from which they are computed. Several threads call `did`, each with
  /// the amount of work that it has just finished (work_of_site).
  void prepare(const std::vector<std::size_t>& collocation_points,
               const std::vector<std::size_t>& judged, const std::function<void(std::size_t)>& did);
  bool makeOneOf(const std::vector<std::size_t>& sites);
  // Collocation points are prepared in two parts. The first part, begin..., changes shared data.
  // The second changes only the collocation point, so it can run in parallel; it requires that the
  // sites it reads are prepared.
  void beginCollocationPoint(std::size_t collocation_point);
  void interpolateTo(std::size_t collocation_point);
  /// Keeps what judge() needs of a prepared site.
  void keep(std::size_t site);
  /// Returns the index of the tree for the lattice of `like` with these cells split. Creates the
  /// tree if needed.
  std::size_t treeOf(const SpaceTable& like, const std::vector<LatticeCell>& splits);
  /// Calls visit(NearCollocationPoint) for each collocation point within reach of s, in a fixed
  /// order. p: displacement in the ball, metres.
  template <class Visit>
  void eachCollocationPoint(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                            Visit visit) const noexcept;
  /// Calls visit(judgement, weight, slope) for each site within reach of s; slope is the derivative
  /// of the site's weight with respect to s.
  template <class Visit>
  void eachSite(const Eigen::Vector3d& s, Visit visit) const noexcept;
  AreaSample inRegion(const Eigen::Vector3d& s, const Eigen::Vector3d& p) const noexcept;
  AreaSample beyondRegion(const Eigen::Vector3d& s, const PlacedEdge& edge,
                          const Eigen::Vector3d& unit, double depth) const noexcept;
  double leastRadiusAt(const Eigen::Vector3d& s) const noexcept;
  PlacedEdge edgeAt(const Eigen::Vector3d& s, const Eigen::Vector3d& unit) const noexcept;
  Eigen::Vector3d driveSlope(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                             const Eigen::Vector3d& direction, double energy_slope) const noexcept;
  double orderDifference(const Eigen::Vector3d& s, const Eigen::Vector3d& p) const noexcept;

  std::vector<const SpaceTable*> spaces_;  ///< spaces of the sites
  double radius_ = 0, finger_ = 0;         ///< m, radii of the ball and of the finger
  /// One tree for each pattern of refinement. Only the positions of the slots are used, not their
  /// kinds (except hanging).
  std::vector<CellTree> trees_;
  std::map<std::vector<LatticeCell>, std::size_t> tree_of_splits_;
  NearPoints sites_, collocation_points_;
  std::vector<CollocationPoint> at_collocation_points_;  ///< per collocation point
  std::vector<Judgement> judgements_;                    ///< per site

  // Used only during preparation.
  std::vector<SiteFits> fits_;                 ///< per thread
  std::vector<std::optional<SiteJets>> made_;  ///< per site
  std::size_t made_count_ = 0;
  bool is_whole_ = false;
};

/// An area's energy at a fixed place, as a force field of p alone.
class FieldAtPlace : public ForceField {
 public:
  FieldAtPlace(std::shared_ptr<const AreaField> area, const Eigen::Vector3d& place)
      : area_(std::move(area)), place_(place) {
    PALPATE_ASSERT(area_, "an area must be prepared before fields at its sites");
  }
  ForceSample evaluate(const Eigen::Vector3d& displacement) const noexcept override {
    return area_->evaluate(place_, displacement);
  }
  std::string_view name() const override { return "potential"; }

 private:
  std::shared_ptr<const AreaField> area_;
  Eigen::Vector3d place_;
};

}  // namespace palpate
