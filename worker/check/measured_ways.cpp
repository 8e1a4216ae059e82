#include "worker/check/measured_ways.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "common/base/assertion.hpp"
#include "worker/solver/transition.hpp"

namespace palpate {
namespace {

/// Not the time of day: other programs that keep the cores busy would be counted.
double processorSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Number n of a sequence that fills the unit cube evenly, however many are taken (Roberts' R3).
Eigen::Vector3d evenlySpread(std::size_t n) {
  constexpr double g = 1.2207440846057596;  // the root of x^4 = x + 1
  const Eigen::Array3d step(1 / g, 1 / (g * g), 1 / (g * g * g));
  const Eigen::Array3d place = 0.5 + static_cast<double>(n) * step;
  return place - place.floor();
}

/// The point of the unit sphere over two numbers from 0 to 1, in equal areas.
Eigen::Vector3d directionAt(double height, double turn) {
  const double z = 1 - 2 * height, r = std::sqrt(1 - z * z), angle = 2 * M_PI * turn;
  return {r * std::cos(angle), r * std::sin(angle), z};
}

class Measurement {
 public:
  Measurement(const Problem& problem, const MeasuringLimits& limits)
      : problem_(problem),
        limits_(limits),
        began_(processorSeconds()),
        solver_(problem, chooseKernels()) {}

  MeasuredWays run() {
    while (!over() && found_.no_rest.empty()) {
      const Eigen::Vector3d place = evenlySpread(found_.ways.size() + 1);
      const auto n_spaces = static_cast<double>(problem_.active.size());
      solver_.chooseTool(static_cast<std::size_t>(place[2] * n_spaces));
      walk(directionAt(place[0], place[1]));
    }
    found_.seconds = processorSeconds() - began_;
    return std::move(found_);
  }

 private:
  bool over() const {
    return found_.transitions > 0 && (found_.transitions >= limits_.transitions ||
                                      processorSeconds() - began_ > limits_.seconds);
  }

  void walk(const Eigen::Vector3d& direction) {
    const Workspace& workspace = problem_.scene.workspace;
    // The start belongs to the step: a worker makes it ready for every job too.
    double step_began = processorSeconds();
    Failure failure;
    std::optional<Start> start = solver_.startAtRest(failure);
    if (!start) {
      found_.no_rest = describe(failure);
      return;
    }
    PALPATE_ASSERT(workspace.spacing > 0, "a way of steps without length would not end");
    Way& way = found_.ways.emplace_back();
    for (double at = 0; at < workspace.radius;) {
      if (over()) {
        way.end = WayEnd::cut;
        return;
      }
      // The rest of a spacing would be a transition of its own that no lattice has.
      at = at + 1.5 * workspace.spacing > workspace.radius ? workspace.radius
                                                           : at + workspace.spacing;
      const Reached reached = start ? solver_.reach(*start, at * direction) : Reached{};
      const Outcome& outcome = reached.outcome;
      way.steps.push_back({processorSeconds() - step_began, outcome.converged});
      ++found_.transitions;
      if (!outcome.converged || outcome.equilibrium.force.norm() > workspace.max_force) {
        way.end = outcome.converged ? WayEnd::max_force : WayEnd::failed;
        return;
      }
      step_began = processorSeconds();
      start = solver_.startFrom(outcome.fields, reached.end.state.displacement, failure);
    }
  }

  const Problem& problem_;
  const MeasuringLimits limits_;
  const double began_;
  TransitionSolver solver_;
  MeasuredWays found_;
};

}  // namespace

MeasuredWays measureWays(const Problem& problem, const MeasuringLimits& limits) {
  PALPATE_ASSERT(!problem.active.empty(), "a problem that resolve() made has something to touch");
  return Measurement(problem, limits).run();
}

}  // namespace palpate
