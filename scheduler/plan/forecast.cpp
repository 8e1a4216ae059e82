#include "scheduler/plan/forecast.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// `usual_growth` is the growth by refinement that is expected while few spaces are finished, as a
/// fraction of the uniform lattice. In the mean growth (growthOf) it weighs as much as finished
/// spaces with a fraction `worth` of all lattice points. The weight does not fall as spaces finish,
/// because the first ones to finish grow most.
constexpr double usual_growth = 0.2, worth = 0.25;

/// Counts of points by outcome, and of attempts, in all uniform lattices so far.
struct Fates {
  double went_on = 0, ended = 0, attempts = 0, tried = 0;
  /// Mean number of attempts per tried point, which may fail from some neighbours.
  double triesEach() const { return (attempts + 1) / (tried + 1); }
  /// Probability that solving continues beyond a point.
  double share() const { return (went_on + 1) / (went_on + ended + 1); }
};

/// True if no transition may start from this point.
bool ended(const SpacePlan& plan, std::int32_t n) {
  const Tag tag = plan.points().tag(n);
  return tag == Tag::terminating || tag == Tag::failed ||
         (tag == Tag::unknown && !plan.points().attempts(n).empty());
}

void count(const SpacePlan& plan, Fates& fates) {
  const PointCounts& points = plan.points().uniform();
  fates.went_on += points.of(Tag::expandable);
  fates.ended += points.of(Tag::terminating) + points.of(Tag::failed) + points.unknown_tried;
  fates.tried += points.solved() + points.unsolved_tried;
  fates.attempts += static_cast<double>(points.attempts) + points.solved();
}

/// Probability that an unknown point of the lattice is tried, judged by the points on the straight
/// line from rest to it.
double chanceOf(const SpacePlan& plan, std::int32_t target, double share) {
  const Lattice& positions = plan.positions();
  const LatticePoint& point = positions.point(target);
  const std::int32_t divisions = positions.divisions();
  const std::int32_t shells =
      std::max({std::abs(point[0]), std::abs(point[1]), std::abs(point[2])}) / divisions;
  double chance = 1;
  for (std::int32_t shell = shells - 1; shell >= 0; --shell, chance *= share) {
    LatticePoint nearer;
    for (int i = 0; i < 3; ++i)
      nearer[i] = divisions * static_cast<std::int32_t>(
                                  std::lround(double(point[i]) / divisions * shell / shells));
    const auto n = positions.indexOf(nearer);
    if (!n) continue;
    if (plan.points().tag(*n) == Tag::expandable) return chance;
    if (ended(plan, *n)) return 0;
  }
  return chance;
}

/// Visits every n-th point of all lattices, with n such that it visits about most_forecast points.
class Sample {
 public:
  explicit Sample(const std::vector<SpacePlan>& plans) {
    std::int64_t points = 0;
    for (const SpacePlan& plan : plans) points += plan.positions().uniformSize();
    every_ = std::max<std::int64_t>(1, points / most_forecast);
  }

  double expectedOfLattice(const SpacePlan& plan, double share) {
    double expected = 0;
    const std::int32_t size = plan.positions().uniformSize();
    for (; next_ < size; next_ += every_) {
      const auto n = static_cast<std::int32_t>(next_);
      if (plan.points().tag(n) == Tag::unknown && plan.points().attempts(n).empty())
        expected += static_cast<double>(every_) * chanceOf(plan, n, share);
    }
    next_ -= size;
    // Open transitions are already counted in Forecast::ready.
    return std::max(0.0, expected - plan.openCount());
  }

 private:
  std::int64_t every_;
  std::int64_t next_ = 0;  ///< index of the next visited point, in the lattice visited next
};

double grown(const SpacePlan& plan) {
  return plan.positions().size() - plan.positions().uniformSize();
}

/// Expected growth by refinement, as a fraction of a uniform lattice: the weighted mean of
/// usual_growth and of the growth of the spaces that have finished growing.
double growthOf(const Problem& problem, const std::vector<SpacePlan>& plans) {
  double more = 0, lattice = 0, all = 1;
  for (std::size_t space = 0; space < plans.size(); ++space) {
    const SpacePlan& plan = plans[space];
    if (problem.active[space].probe) continue;
    all += plan.positions().uniformSize();
    if (plan.mayGrow()) continue;
    more += grown(plan);
    lattice += plan.positions().uniformSize();
    if (plan.stage() >= Stage::probes) more -= probesIn(problem.scene, space);
  }
  return std::max(0.0, (more + usual_growth * worth * all) / (lattice + worth * all));
}

}  // namespace

Forecast forecastOf(const Problem& problem, const std::vector<SpacePlan>& plans) {
  Fates fates;
  for (const SpacePlan& plan : plans) count(plan, fates);
  const double growth = growthOf(problem, plans);
  Forecast forecast;
  Sample sample(plans);
  for (std::size_t space = 0; space < plans.size(); ++space) {
    const SpacePlan& plan = plans[space];
    if (plan.complete()) continue;
    forecast.ready += plan.openCount();
    if (problem.active[space].probe) {
      // A space with a probe consists of the rest position, which is ready at once, and the probe.
      forecast.expected += plan.stage() < Stage::probes ? 1 : 0;
      continue;
    }
    if (plan.stage() < Stage::probes) forecast.expected += probesIn(problem.scene, space);
    if (plan.stage() == Stage::lattice)
      forecast.expected += sample.expectedOfLattice(plan, fates.share());
    if (plan.mayGrow())
      forecast.expected += plan.laterPoints().value_or(growth * plan.positions().uniformSize());
  }
  forecast.expected += (fates.triesEach() - 1) * (forecast.ready + forecast.expected);
  return forecast;
}

}  // namespace palpate
