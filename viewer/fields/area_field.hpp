#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "common/base/assertion.hpp"
#include "common/mesh/near_points.hpp"
#include "viewer/fields/cell_data.hpp"
#include "viewer/fields/force_field.hpp"
#include "viewer/fields/site_jets.hpp"

namespace palpate {

/// What the energy of an area says about a finger at s with the displacement p.
struct AreaSample : ForceSample {
  /// N, T = -dE/ds: what drives the finger, in space; what of it lies in the surface moves it
  /// along.
  Eigen::Vector3d drive = Eigen::Vector3d::Zero();
};

/// The chosen ones of all spaces, which outlive what is returned.
std::vector<const SpaceTable*> chosenOf(const std::vector<SpaceTable>& spaces,
                                        const std::vector<std::size_t>& chosen);
/// Where the fingers of these spaces stand, metres.
std::vector<Eigen::Vector3d> centersOf(const std::vector<const SpaceTable*>& sites);

/// One energy E(s, p) of a finger over an area, its place s and its displacement p: force = -dE/dp
/// and drive = -dE/ds. So every loop in (s, p) is closed in energy, over places where other sites
/// take over too.
///
/// At each site and each solved p the energy is known to the third order in s and p, exactly (by s
/// alone to the second; of the third order what counts, see LocalFits::judge).
/// - In p the ten quantities of a site are interpolated on its lattice, which may be refined
///   (site_jets.hpp).
/// - From the sites they are interpolated to *collocation points*, places closer together, by a
/// kernel that
///   meets values, gradients and curvatures at the seven nearest sites (hermite_kernel.hpp). This
///   is what makes few sites enough: its error goes with about the fifth power of their distance.
///   A collocation point's lattice is refined where that of one of them is.
/// - Around a collocation point E is its expansion Q to the second order in s - collocation point,
/// and expansions are
///   blended by a partition of unity (Shepard 1968)
///
///     E(s, p) = sum of w(|d| / reach) Q(d, p) / sum of w,    w(x) = (1 - x)^4 (4 x + 1)
///
///   (Wendland 1995), smooth in space: there is no triangulation of sites, no edge where a force
///   could jump, and nothing special about thin lobes, rims or several bodies.
/// E is twice continuously differentiable in s and in p.
///
/// The error bound adds shares, which were measured, of that of the interpolation in p, of what
/// each site lacks when it is interpolated from the others around it, and of the force.
///
/// Prepared as a whole, or only where a finger is: for a page, which must not make its reader wait,
/// and for commands that ask a few places. Where it is prepared it says the same to the last bit.
///
/// One thread prepares, while nobody evaluates; else any thread may evaluate.
class AreaField {
 public:
  /// Metres.
  struct CollocationPoints {
    std::vector<Eigen::Vector3d> places;
  };
  /// Nothing is prepared yet. `sites` are spaces of fingers of one radius, of one build, and
  /// outlive what is prepared of them; `collocation points` those of the whole area, at least one.
  /// Error when a site has cells that are halved more often than a build does.
  AreaField(std::vector<const SpaceTable*> sites, CollocationPoints collocation_points);
  /// All is prepared, with `progress` (prepareAll). `surface`: as for collocationPointsOf.
  AreaField(const std::vector<const SpaceTable*>& sites,
            const std::vector<Eigen::Vector3d>& surface,
            const std::function<void(double)>& progress = {});
  /// The collocation points of an area. `surface`: places of the body's surface around the sites,
  /// close together against the radius (placesAround of common/problem/sites.hpp). Quick.
  static CollocationPoints collocationPointsOf(const std::vector<const SpaceTable*>& sites,
                                               const std::vector<Eigen::Vector3d>& surface);

  /// Side by side on all cores, any of which calls `progress` with the share of the work that is
  /// done, up to 1; what it throws ends the making. Error when a site has no solved point. The
  /// sites are not read any more after it.
  void prepareAll(const std::function<void(double)>& progress = {});
  /// What a finger at s (metres) needs, side by side on all cores. Error as prepareAll().
  void prepareAt(const Eigen::Vector3d& s);
  /// One piece of that, some milliseconds of work; false when nothing is lacking there. Error as
  /// prepareAll().
  bool prepareNext(const Eigen::Vector3d& s);
  /// One site that is not made yet, of all the nearest to s; false when all are. Where sites are
  /// made, the rest is quick.
  bool prepareSite(const Eigen::Vector3d& s);

  /// s: metres, where the surface is at rest; p: displacement, metres, any value. Beyond what was
  /// computed around s the sample is the continuation of answered_region.hpp, one energy over s
  /// too; where no site is within reach of s the sample is not inside, and fades out to nothing;
  /// where it is not prepared the sample is not inside and has no force. Of a single site there is
  /// no bound (NaN), because nothing tells how its expansion does beside it. Real time.
  AreaSample evaluate(const Eigen::Vector3d& s, const Eigen::Vector3d& p) const noexcept;

  std::size_t siteCount() const { return sites_.points().size(); }
  std::size_t madeSites() const { return made_count_; }
  std::size_t collocationPointCount() const { return collocation_points_.points().size(); }
  double siteReach() const { return sites_.reach(); }  ///< m: farther away a site says nothing
  /// The numbers of those that say something at a place, metres.
  std::vector<std::size_t> sitesAt(const Eigen::Vector3d& s) const;
  const Eigen::Vector3d& siteCenter(std::size_t site) const { return sites_.points()[site]; }

 private:
  /// The lattice of a collocation point, and what is interpolated to it.
  struct CollocationPoint {
    std::size_t tree = 0;
    std::vector<SiteJet> jets;  ///< per slot of the tree
    double power = 0;           ///< HermiteWeights::power
  };
  /// What is said at a slot of a site's lattice.
  struct Doubt {
    /// Of the force, by the root of the power of the place: what is lacking when the others around
    /// stand in.
    float lack = 0;
    float coverage = 0;  ///< as ForceSample::coverage
  };
  struct Judgement {
    std::size_t tree = 0;
    std::vector<Doubt> doubts;  ///< per slot of the tree
    FieldError p_error;         ///< of its leaves
    AnsweredRegion region;
  };
  /// Where the answers at a place end along one direction.
  struct PlacedEdge : RegionEdge {
    /// By the place: m/m and N/m per m.
    Eigen::Vector3d radius_by_s = Eigen::Vector3d::Zero(), stiffness_by_s = Eigen::Vector3d::Zero();
  };
  /// A collocation point within reach of a place, and what is known of a displacement there.
  struct NearCollocationPoint;
  /// Sums over the collocation points whose leaves around a displacement are on one level: all are
  /// the same.
  struct LevelSum;

  std::vector<std::size_t> collocationPointsAt(const Eigen::Vector3d& s) const;
  // What collocation points and judgements are made from.
  std::vector<std::size_t> sitesOfCollocationPoint(std::size_t collocation_point) const;
  std::vector<std::size_t> sitesOfJudgement(std::size_t site) const;
  bool isInterpolated(std::size_t collocation_point) const {
    return !at_collocation_points_[collocation_point].jets.empty();
  }
  bool isJudged(std::size_t site) const { return !judgements_[site].doubts.empty(); }
  bool isPreparedAt(const Eigen::Vector3d& s) const noexcept;

  /// Those of these collocation points and sites that are lacking, with the sites that they need.
  /// `did` is told how much work is done, by any thread.
  void prepare(const std::vector<std::size_t>& collocation_points,
               const std::vector<std::size_t>& judged, const std::function<void(std::size_t)>& did);
  bool makeOneOf(const std::vector<std::size_t>& sites);
  // In two parts: the first changes what all share, the second is of this collocation point or site
  // alone, whose sites are made.
  void beginCollocationPoint(std::size_t collocation_point);
  void interpolateTo(std::size_t collocation_point);
  void beginJudgement(std::size_t site);
  void judge(std::size_t site);
  /// The number of the tree of a lattice like that of a space, with these cells split.
  std::size_t treeOf(const SpaceTable& like, const std::vector<LatticeCell>& splits);
  /// visit(NearCollocationPoint), in a fixed order; p: in the ball.
  template <class Visit>
  void eachCollocationPoint(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                            Visit visit) const noexcept;
  /// visit(judgement, weight of the site, by s).
  template <class Visit>
  void eachSite(const Eigen::Vector3d& s, Visit visit) const noexcept;
  AreaSample inRegion(const Eigen::Vector3d& s, const Eigen::Vector3d& p) const noexcept;
  AreaSample beyondRegion(const Eigen::Vector3d& s, const PlacedEdge& edge,
                          const Eigen::Vector3d& unit, double depth) const noexcept;
  double leastRadiusAt(const Eigen::Vector3d& s) const noexcept;
  PlacedEdge edgeAt(const Eigen::Vector3d& s, const Eigen::Vector3d& unit) const noexcept;
  Eigen::Vector3d driveSlope(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                             const Eigen::Vector3d& direction, double energy_slope) const noexcept;
  /// power: HermiteWeights::power at s.
  void addJudgement(const Eigen::Vector3d& s, const Eigen::Vector3d& p, double power,
                    AreaSample& sample) const noexcept;

  std::vector<const SpaceTable*> spaces_;  ///< of the sites
  double radius_ = 0, finger_ = 0;         ///< of the ball, of the finger, m
  /// One for each way in which lattices are refined; of their slots only the places count.
  std::vector<CellTree> trees_;
  std::map<std::vector<LatticeCell>, std::size_t> tree_of_splits_;
  NearPoints sites_, collocation_points_;
  std::vector<CollocationPoint> at_collocation_points_;  ///< per collocation point
  std::vector<Judgement> judgements_;                    ///< per site

  // While it is prepared.
  std::vector<SiteFits> fits_;                 ///< per thread
  std::vector<std::optional<SiteJets>> made_;  ///< per site
  std::size_t made_count_ = 0;
  bool is_whole_ = false;
};

/// What an area says at one of its places, as a field of its own.
class FieldAtPlace : public ForceField {
 public:
  FieldAtPlace(std::shared_ptr<const AreaField> area, const Eigen::Vector3d& place)
      : area_(std::move(area)), place_(place) {
    PALPATE_ASSERT(area_, "areas are made before the fields at their sites");
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
