// How far one equilibrium of a finger reaches, and what a solver that follows a hand costs. Two
// parts:
// - steps: from pressed places on the surface, the finger is moved by given distances (deeper or
//   aside, along the surface, both). The force that the last equilibrium's expansion says there is
//   compared with the exact one, and the work of TransitionSolver::follow() is counted.
// - hands: a hand slides over the surface while it presses more and less. A follower solves where
//   the hand will be when the answer is there; in each tick the force is that of the newest
//   expansion. The forces of every 20th tick are compared with exact ones afterwards.
// Prints one JSON object. Times are processor time of the solving thread.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>

#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/mesh/surface_pieces.hpp"
#include "common/mesh/surface_point.hpp"
#include "common/problem/finger.hpp"
#include "common/scene/active_choice.hpp"
#include "common/space/expansion.hpp"
#include "worker/solver/transition.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string scene, active;
  int places = 40;
  unsigned seed = 1;
  double cone = 60;                                  ///< degrees
  std::vector<double> distances = {1, 2, 3, 5, 10};  ///< mm
  std::vector<double> speeds = {2, 5, 10};           ///< cm/s
  double duration = 10;                              ///< s of each hand
  double latency = 0;                                ///< ms; 0: the processor time of each solve
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// Errors of forces beside exact ones.
struct Errors {
  std::vector<double> relative;
  int within_1 = 0, within_3 = 0;
  void record(const Eigen::Vector3d& found, const Eigen::Vector3d& exact) {
    const double error = (found - exact).norm(), size = exact.norm();
    relative.push_back(error / std::max(size, 0.05));
    within_1 += error <= std::max(0.01 * size, 0.01);
    within_3 += error <= std::max(0.03 * size, 0.02);
  }
  Json toJson() const {
    const double count = std::max(1.0, static_cast<double>(relative.size()));
    return {{"median", quantile(relative, 0.5)},
            {"p95", quantile(relative, 0.95)},
            {"p99", quantile(relative, 0.99)},
            {"within_1_percent_or_10_mN", within_1 / count},
            {"within_3_percent_or_20_mN", within_3 / count}};
  }
};

struct Work {
  std::vector<double> milliseconds;
  int iterations = 0, factorizations = 0, failures = 0;
  void record(const Outcome& outcome) {
    milliseconds.push_back(1e3 * outcome.cost.seconds);
    iterations += outcome.cost.newton_iterations;
    factorizations += outcome.cost.factorizations;
    failures += !outcome.converged();
  }
  Json toJson() const {
    const double count = std::max(1.0, static_cast<double>(milliseconds.size()));
    return {{"solves", milliseconds.size()},
            {"iterations", iterations / count},
            {"factorizations", factorizations / count},
            {"milliseconds_median", quantile(milliseconds, 0.5)},
            {"milliseconds_p95", quantile(milliseconds, 0.95)},
            {"failures", failures}};
  }
};

/// The surface, random places of it, and paths along it.
class Surface {
 public:
  Surface(const Mesh& mesh, double radius, unsigned seed)
      : mesh_(mesh), radius_(radius), random_(seed) {
    double area = 0;
    for (std::int32_t t = 0; t < std::ssize(mesh.surface); ++t)
      forEachPiece(mesh, t, place_distance * radius, [&](const SurfacePiece& piece) {
        places_.push_back(piece.middle);
        normals_.push_back(normalOf(mesh, t));
        areas_.push_back(area += piece.area);
      });
  }
  struct Place {
    Eigen::Vector3d s, normal;
  };
  Place place() {
    const auto n = std::ranges::lower_bound(areas_, number(0, areas_.back())) - areas_.begin();
    return {places_[at(n)], normals_[at(n)]};
  }
  /// Unit vector within `cone` (radians) of the inward normal.
  Eigen::Vector3d inward(const Eigen::Vector3d& normal, double cone) {
    for (;;) {
      const Eigen::Vector3d p(number(-1, 1), number(-1, 1), number(-1, 1));
      if (p.norm() <= 1 && p.norm() > 0.1 && p.dot(normal) <= -std::cos(cone) * p.norm())
        return p.normalized();
    }
  }
  Eigen::Vector3d tangent(const Eigen::Vector3d& normal) {
    const Eigen::Vector3d any(number(-1, 1), number(-1, 1), number(-1, 1));
    return (any - any.dot(normal) * normal).normalized();
  }
  Eigen::Vector3d nearest(const Eigen::Vector3d& s) const {
    return fingerNear("place", mesh_, s, radius_).center;
  }
  double number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

 private:
  const Mesh& mesh_;
  double radius_;
  std::mt19937 random_;
  std::vector<Eigen::Vector3d> places_, normals_;
  std::vector<double> areas_;
};

class Survey {
 public:
  Survey(const Options& options, const Problem& problem, const Finger& finger)
      : options_(options),
        problem_(problem),
        radius_(finger.radius),
        surface_(problem.mesh, finger.radius, options.seed),
        solver_(problem, chooseKernels()) {}

  /// Presses a finger at s along p in steps of 2 mm, until the force is `share` of max_force.
  std::optional<Start> pressed(const Eigen::Vector3d& s, const Eigen::Vector3d& direction,
                               double share) {
    try {
      solver_.placeFinger("place", {s, radius_});
    } catch (const Error&) {
      return std::nullopt;  // beside what is held
    }
    Failure failure;
    const auto rest = solver_.startAtRest(failure);
    if (!rest) return std::nullopt;
    Reached reached = solver_.reach(*rest, Eigen::Vector3d::Zero());
    std::optional<Start> at = std::move(reached.end);
    for (int n = 1; 0.002 * n <= problem_.scene.workspace.radius; ++n) {
      Reached next = solver_.reach(*at, 0.002 * n * direction);
      const double most = share * problem_.scene.workspace.max_force;
      if (!next.outcome.converged() || next.outcome.equilibrium().force.norm() > most) break;
      at = std::move(next.end);
      equilibrium_ = next.outcome.equilibrium();
    }
    if (!at || at->state.displacement.isZero()) return std::nullopt;
    return at;
  }

  Json steps() {
    struct Kind {
      std::string name;
      bool pushes, slides;
    };
    const std::vector<Kind> kinds = {
        {"pushed", true, false}, {"slid", false, true}, {"both", true, true}};
    std::vector<std::vector<std::array<Errors, 3>>> errors(
        kinds.size(), std::vector<std::array<Errors, 3>>(options_.distances.size()));
    std::vector<std::vector<Work>> work(kinds.size(), std::vector<Work>(options_.distances.size()));
    for (int n = 0; n < options_.places; ++n) {
      const auto [s, normal] = surface_.place();
      const Eigen::Vector3d direction = surface_.inward(normal, options_.cone * M_PI / 180);
      const auto start = pressed(s, direction, surface_.number(0.1, 0.9));
      if (!start) continue;
      const Expansion whole = {s, start->state.displacement, equilibrium_};
      Expansion second = whole, first;
      second.equilibrium.stiffness_by_p.setZero();
      second.equilibrium.stiffness_by_s.setZero();
      second.equilibrium.drive_slope_by_p.setZero();
      first = second;
      first.equilibrium.stiffness.setZero();
      first.equilibrium.drive_stiffness.setZero();
      const Eigen::Vector3d push = surface_.inward(normal, options_.cone * M_PI / 180),
                            slide = surface_.tangent(normal);
      for (std::size_t k = 0; k < kinds.size(); ++k)
        for (std::size_t d = 0; d < options_.distances.size(); ++d) {
          const double distance =
              1e-3 * options_.distances[d] / (kinds[k].pushes && kinds[k].slides ? M_SQRT2 : 1);
          const Eigen::Vector3d to = kinds[k].slides ? surface_.nearest(s + distance * slide) : s;
          Eigen::Vector3d p = start->state.displacement;
          if (kinds[k].pushes) p += distance * push;
          try {
            const Reached reached = solver_.follow(*start, {to, radius_}, p);
            work[k][d].record(reached.outcome);
            if (!reached.outcome.converged()) continue;
            const Eigen::Vector3d exact = reached.outcome.equilibrium().force;
            if (exact.norm() > problem_.scene.workspace.max_force) continue;
            errors[k][d][0].record(first.at(to, p).force, exact);
            errors[k][d][1].record(second.at(to, p).force, exact);
            errors[k][d][2].record(whole.at(to, p).force, exact);
          } catch (const Error&) {
            continue;  // beside what is held
          }
        }
    }
    Json json = Json::array();
    for (std::size_t k = 0; k < kinds.size(); ++k)
      for (std::size_t d = 0; d < options_.distances.size(); ++d)
        json.push_back({{"move", kinds[k].name},
                        {"mm", options_.distances[d]},
                        {"force_alone", errors[k][d][0].toJson()},
                        {"with_stiffness", errors[k][d][1].toJson()},
                        {"third_order", errors[k][d][2].toJson()},
                        {"follow", work[k][d].toJson()}});
    return json;
  }

  Json hand(double speed) {
    struct Tick {
      Eigen::Vector3d s, p;
    };
    constexpr double period = 1e-3;
    constexpr int compared_every = 20;
    Errors errors;
    Work work;
    int lost = 0, ticks = 0;
    for (int attempt = 0; attempt < 20 && ticks * period < options_.duration; ++attempt) {
      const auto [place, normal] = surface_.place();
      const auto pressed_there = pressed(place, -normal, 0.4);
      if (!pressed_there) continue;
      // The hand: it slides at `speed`, and presses to between a fifth and all of this depth.
      const double depth = pressed_there->state.displacement.norm();
      const int count = static_cast<int>(std::min(2.0, options_.duration) / period);
      std::vector<Tick> path;
      Eigen::Vector3d s = place, along = surface_.tangent(normal), out = normal;
      for (int n = 0; n < count; ++n) {
        const double phase = speed / depth * n * period;
        path.push_back({s, -depth * (0.6 + 0.4 * std::cos(phase)) * out});
        const Eigen::Vector3d next = surface_.nearest(s + speed * period * along);
        const Eigen::Vector3d moved = next - s;
        const Eigen::Vector3d turned = normalNear(next);
        out = (0.95 * out + 0.05 * turned).normalized();
        s = next;
        if (moved.norm() < 0.2 * speed * period) {
          along = surface_.tangent(out);  // at a rim
        } else {
          along = (along + 0.2 * (moved.normalized() - along)).normalized();
        }
        along = (along - along.dot(out) * out).normalized();
      }
      std::optional<Start> at = pressed_there;
      Expansion newest = {place, at->state.displacement, equilibrium_}, coming = newest;
      double busy_until = 0;
      bool solving = false;
      std::vector<Eigen::Vector3d> forces;
      double took = 0.02;
      for (int n = 0; n < count; ++n) {
        const double now = n * period;
        if (solving && now >= busy_until) {
          newest = coming;
          solving = false;
        }
        forces.push_back(newest.at(path[at_(n)].s, path[at_(n)].p).force);
        if (solving || n < 5) continue;
        // Aimed at the middle of the time in which this answer will be the newest.
        const double ahead = 1.5 * took / (5 * period);
        const Tick &here = path[at_(n)], &before = path[at_(n - 5)];
        const Eigen::Vector3d aim = surface_.nearest(here.s + ahead * (here.s - before.s)),
                              press = here.p + ahead * (here.p - before.p);
        try {
          Reached reached = solver_.follow(*at, {aim, radius_}, press);
          work.record(reached.outcome);
          took = options_.latency > 0 ? 1e-3 * options_.latency : reached.outcome.cost.seconds;
          if (reached.outcome.converged()) {
            coming = {aim, press, reached.outcome.equilibrium()};
            at = std::move(reached.end);
          } else {
            ++lost;
          }
          busy_until = now + took;
          solving = true;
        } catch (const Error&) {
          continue;  // beside what is held
        }
      }
      // The exact forces, on the hand's branch.
      std::optional<Start> exact = pressed_there;
      for (int n = 0; n < count; n += compared_every) {
        try {
          Reached reached = solver_.follow(*exact, {path[at_(n)].s, radius_}, path[at_(n)].p);
          if (!reached.outcome.converged()) break;
          exact = std::move(reached.end);
          if (reached.outcome.equilibrium().force.norm() <= problem_.scene.workspace.max_force)
            errors.record(forces[at_(n)], reached.outcome.equilibrium().force);
          ticks += compared_every;
        } catch (const Error&) {
          break;
        }
      }
    }
    return {{"cm_per_s", 100 * speed},
            {"seconds", ticks * period},
            {"force", errors.toJson()},
            {"follow", work.toJson()},
            {"lost", lost}};
  }

  Json run() {
    Json json = {{"benchmark", "live_survey"},
                 {"scene", options_.scene},
                 {"nodes", problem_.mesh.nodes.size()},
                 {"finger_radius", radius_}};
    json["steps"] = steps();
    json["hands"] = Json::array();
    for (const double speed : options_.speeds) json["hands"].push_back(hand(0.01 * speed));
    return json;
  }

 private:
  static std::size_t at_(int n) { return static_cast<std::size_t>(n); }
  /// The mean of the normals under the finger.
  Eigen::Vector3d normalNear(const Eigen::Vector3d& s) const { return pushedNormal(s); }
  Eigen::Vector3d pushedNormal(const Eigen::Vector3d& s) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::int32_t t = 0; t < std::ssize(problem_.mesh.surface); ++t) {
      const auto& corners = problem_.mesh.surface[at(t)];
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      for (int c = 0; c < 3; ++c) middle += problem_.mesh.nodes[at(corners[at(c)])] / 3;
      const double r = (middle - s).norm() / (2 * radius_);
      if (r < 1) sum += (1 - r * r) * (1 - r * r) * normalOf(problem_.mesh, t);
    }
    return sum.normalized();
  }

  const Options& options_;
  const Problem& problem_;
  double radius_;
  Surface surface_;
  TransitionSolver solver_;
  Equilibrium equilibrium_;
};

int main(int argc, char** argv) {
  Options options;
  CLI::App app("How far one equilibrium of a finger reaches, and what following a hand costs");
  app.add_option("SCENE", options.scene)->required()->check(CLI::ExistingFile);
  app.add_option("--active", options.active, "name of the finger's area");
  app.add_option("--places", options.places, "places for the part `steps`")->capture_default_str();
  app.add_option("--seed", options.seed)->capture_default_str();
  app.add_option("--distances", options.distances, "mm")->capture_default_str();
  app.add_option("--speeds", options.speeds, "of the hand, cm/s")->capture_default_str();
  app.add_option("--duration", options.duration, "s of each hand")->capture_default_str();
  app.add_option("--latency", options.latency, "ms of each solve instead of its processor time");
  CLI11_PARSE(app, argc, argv);
  const Problem problem = loadProblem(options.scene);
  const ActiveChoice chosen = chooseActive(problem.scene, options.active);
  const ActivePatch& patch = problem.active.at(chosen.spaces.front());
  if (!patch.finger) throw badInput("--active {} is no finger", options.active);
  fmt::print("{}\n", Survey(options, problem, *patch.finger).run().dump(1));
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    return palpate::main(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "palpate_live_survey: {}\n", error.what());
    return 1;
  }
}
