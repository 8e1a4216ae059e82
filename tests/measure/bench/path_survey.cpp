// The paper's stability test: paths of 100 mm in 26 directions from ten active nodes, with the body
// fixed in two ways; and random paths. Counts valid paths, or paths that merely converge.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/mesh/mesh_reader.hpp"
#include "common/problem/problem.hpp"
#include "tests/support/problems.hpp"
#include "worker/solver/newton.hpp"
#include "worker/solver/path.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::filesystem::path mesh;
  std::string law = "mooney-rivlin";
  std::string constraint = "ln-det-F";
  std::string tool = "rigid";
  double radius = 0;
  double length = 0.1;
  double transition = 0.02;
  int nodes = 10;
  int budget = TransitionOptions{}.max_factorizations;
  bool every_path = false;
  // Selects parts of the survey.
  std::string axis = "both";
  int only_node = -1;
  int directions = 26;
  // Other paths, and other step sizes.
  int random = 0, steps = 200;
  unsigned seed = 2010;
  bool fixed_steps = false;
  bool merely_converged = false;
  int iterations = 20;
};

Scene sceneOf(const Options& options) {
  Scene scene = test::mooneyRivlinScene();
  if (options.law == "modified-st-venant-kirchhoff") {
    scene = test::youngScene(LawName::modified_st_venant_kirchhoff);
    scene.regions[0].material.poisson.reset();
  } else if (options.law == "st-venant-kirchhoff") {
    scene = test::youngScene(LawName::st_venant_kirchhoff, 0.49);
  }
  scene.discretization.constraint =
      options.constraint == "ln-det-F" ? Constraint::ln_det_F : Constraint::det_F_minus_1;
  if (options.merely_converged) {
    scene.workspace.reject_inverted = false;
    scene.discretization.constraint = Constraint::det_F_minus_1;
    if (scene.discretization.pressure == PressureSpace::p1_stabilized)
      scene.discretization.pressure = PressureSpace::p1;
  }
  return scene;
}

ToolKind toolNamed(const std::string& word) {
  const auto& words = words_of<ToolKind>;
  return static_cast<ToolKind>(std::find(words.begin(), words.end(), word) - words.begin());
}

/// Surface nodes far from fixed nodes and from each other: each is the farthest from all earlier
/// ones.
std::vector<std::int32_t> spreadNodes(const Mesh& mesh, const std::vector<std::int32_t>& fixed,
                                      int count) {
  constexpr double clearance = 0.03;
  std::vector<std::int32_t> candidates;
  std::vector<double> distance;
  for (const std::int32_t node : surfaceNodes(mesh)) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::int32_t held : fixed)
      nearest = std::min(nearest, (mesh.nodes[node] - mesh.nodes[held]).norm());
    if (nearest < clearance) continue;
    candidates.push_back(node);
    distance.push_back(nearest);
  }
  if (std::ssize(candidates) < count)
    throw badInput("--nodes {}: {} surface nodes are {:g} mm or more from what is held", count,
                   candidates.size(), 1000 * clearance);
  std::vector<std::int32_t> chosen;
  while (static_cast<int>(chosen.size()) < count) {
    const auto farthest = std::max_element(distance.begin(), distance.end()) - distance.begin();
    chosen.push_back(candidates[farthest]);
    for (std::size_t n = 0; n < candidates.size(); ++n)
      distance[n] =
          std::min(distance[n], (mesh.nodes[candidates[n]] - mesh.nodes[chosen.back()]).norm());
  }
  return chosen;
}

Problem problemOf(const Options& options, int axis) {
  Scene scene = sceneOf(options);
  scene.fixed = {};
  scene.fixed.half_spaces = {{axis, true, 0.15, std::nullopt}};
  ActiveSelection active;
  active.name = "any";
  active.near = Eigen::Vector3d::Zero();
  scene.active = {active};
  Mesh mesh = readGmsh(options.mesh);
  // First only for the fixed nodes, from which the active ones keep a distance.
  Scene first = scene;
  first.active[0].near = mesh.nodes[surfaceNodes(mesh).back()];
  const auto highest =
      std::max_element(mesh.nodes.begin(), mesh.nodes.end(),
                       [&](const auto& a, const auto& b) { return a[axis] < b[axis]; });
  first.active[0].near = *highest;
  const Problem held = resolve(first, mesh);
  scene.active.clear();
  for (const std::int32_t node : spreadNodes(held.mesh, held.fixed, options.nodes)) {
    active.near.reset();
    active.node = node;
    active.name = fmt::format("node-{}", node);
    active.radius = options.radius;
    active.tool = toolNamed(options.tool);
    scene.active.push_back(active);
  }
  return resolve(std::move(scene), std::move(mesh));
}

using Points = std::vector<Eigen::Vector3d>;  ///< displacements from rest, m

/// The end of a path, and its quality.
struct Walked {
  bool complete = false;
  int transitions = 0;  ///< completed transitions
  int detours = 0;
  double min_det_F = 1;
  /// Whether all configurations have the right inertia; empty if the number of negative pivots is
  /// meaningless.
  std::optional<bool> right_inertia;
  Failure failure;  ///< of the first transition that failed
  Cost cost;
};

/// Walks through valid configurations: min det F > 0, and the inertia of a stable equilibrium.
class ValidWalker {
 public:
  ValidWalker(const Problem& problem, const Options& options)
      : rescue_(options.fixed_steps ? Rescue::none : Rescue::detours),
        solver_(problem, chooseKernels(), transitionOf(options)) {}

  void chooseTool(std::size_t space) {
    solver_.chooseTool(space);
    Failure failure;
    auto rest = solver_.startAtRest(failure);
    if (!rest) throw palpate::failure("rest: {}", describe(failure));
    rest_ = std::move(*rest);
  }

  Walked along(const Points& points) {
    Walked walked;
    Start at = rest_;
    for (const Eigen::Vector3d& target : points) {
      Reached path = walk(solver_, at, target, 1, rescue_);
      walked.cost += path.outcome.cost;
      walked.detours += path.detours;
      if (!path.outcome.converged()) {
        walked.failure = path.outcome.failure();
        return walked;
      }
      walked.min_det_F = std::min(walked.min_det_F, path.min_det_F);
      ++walked.transitions;
      at = std::move(*path.end);
    }
    walked.complete = true;
    return walked;
  }

 private:
  static TransitionOptions transitionOf(const Options& options) {
    TransitionOptions transition;
    transition.max_factorizations = options.budget;
    if (options.fixed_steps) transition.smallest_step = 1;
    return transition;
  }

  Rescue rescue_;
  TransitionSolver solver_;
  Start rest_;
};

/// The paper's criterion: Newton starts from the last configuration, and any converged state is
/// continued, whatever its inertia and even with inverted elements.
class ConvergingWalker {
 public:
  ConvergingWalker(const Problem& problem, const Options& options)
      : halves_(!options.fixed_steps),
        most_iterations_(options.iterations),
        system_(problem, chooseKernels()),
        solver_(system_) {}

  void chooseTool(std::size_t space) { system_.chooseTool(space); }

  Walked along(const Points& points) {
    const auto began = std::chrono::steady_clock::now();
    Walked walked;
    State state = system_.restState();
    if (system_.expectedNegativePivots()) walked.right_inertia = true;
    walked.complete = std::all_of(points.begin(), points.end(), [&](const auto& target) {
      const bool there = reach(state, target, walked);
      walked.transitions += there ? 1 : 0;
      return there;
    });
    walked.cost.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return walked;
  }

 private:
  /// Halves steps that do not converge, unless steps are fixed.
  bool reach(State& state, const Eigen::Vector3d& target, Walked& walked) {
    const Eigen::Vector3d origin = state.displacement;
    double at = 0, length = 1;  // fractions of the whole step
    while (at < 1) {
      const double next = std::min(1.0, at + length);
      const NewtonResult newton =
          converge(state, next == 1 ? target : Eigen::Vector3d(origin + next * (target - origin)));
      walked.cost.newton_iterations += newton.iterations;
      walked.cost.factorizations += newton.factorizations;
      if (newton.cause == Cause::none) {
        accept(newton, walked);
        state = newton.state;
        at = next;
        continue;
      }
      length = (next - at) / 2;
      if (halves_ && length >= TransitionOptions{}.smallest_step) continue;
      walked.failure = {.cause = newton.cause,
                        .step_reached = at,
                        .residual = newton.residual.norm,
                        .element = newton.residual.worst_element,
                        .element_det_F = newton.residual.min_det_F,
                        .negative_pivots = newton.factorization.negative_pivots};
      return false;
    }
    return true;
  }

  /// Newton without a line search. The first step also moves the tool, as with a multiplier.
  NewtonResult converge(const State& from, const Eigen::Vector3d& displacement) {
    NewtonResult now;
    Tangent tangent;
    Eigen::Vector3d way = displacement - from.displacement;
    now.state = from;
    system_.assemble(now.state, now.residual, tangent);
    do {
      if (now.iterations == most_iterations_) now.cause = Cause::iteration_limit;
      if (!std::isfinite(now.residual.norm)) now.cause = Cause::not_finite;
      if (now.cause != Cause::none) return now;
      Eigen::VectorXd step = -now.residual.free - tangent.tool_coupling * way;
      now.factorization = solver_.factorize(tangent);
      ++now.factorizations;
      if (!now.factorization.ok || !solver_.solve(step)) {
        now.cause = Cause::factorization_failed;
        return now;
      }
      now.state = system_.moved(now.state, step, 1, displacement);
      system_.assemble(now.state, now.residual, tangent);
      way.setZero();
      ++now.iterations;
    } while (!(now.residual.norm <= toleranceAt(now.residual)));
    return now;
  }

  double toleranceAt(const Residual& residual) const {
    const NewtonOptions options;
    return options.absolute_tolerance * (system_.forceScale() + system_.totalLoad()) +
           options.relative_tolerance * residual.tool.norm();
  }

  void accept(const NewtonResult& newton, Walked& walked) const {
    walked.min_det_F = std::min(walked.min_det_F, newton.residual.min_det_F);
    ++walked.cost.steps;
    if (const auto expected = system_.expectedNegativePivots())
      walked.right_inertia =
          *walked.right_inertia && newton.factorization.negative_pivots == *expected;
  }

  bool halves_;
  int most_iterations_;
  System system_;
  TangentSolver solver_;
};

struct Path {
  std::string node;
  Eigen::Vector3d direction;  ///< from the start of a random path to its end
  Points points;
};

std::vector<Path> regularPaths(const Options& options) {
  const int transitions = static_cast<int>(std::round(options.length / options.transition));
  std::vector<Path> all;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k) {
        if (i == 0 && j == 0 && k == 0) continue;
        Path path = {.node = {}, .direction = Eigen::Vector3d(i, j, k), .points = {}};
        const Eigen::Vector3d target = options.length * path.direction.normalized();
        for (int n = 1; n < transitions; ++n) path.points.emplace_back(target * n / transitions);
        path.points.push_back(target);
        all.push_back(std::move(path));
      }
  // A uniform selection of them.
  std::vector<Path> some;
  for (int n = 0; n < options.directions; ++n)
    some.push_back(all[n * all.size() / static_cast<std::size_t>(options.directions)]);
  return some;
}

Eigen::Vector3d inBall(std::mt19937_64& generator, double radius) {
  std::uniform_real_distribution<double> coordinate(-radius, radius);
  for (;;) {
    Eigen::Vector3d place;
    for (double& x : place) x = coordinate(generator);
    if (place.norm() <= radius) return place;
  }
}

/// Passes through uniformly random places in the ball, one after the other. The remainder of a leg
/// is dropped, so that all steps have the same length.
Path randomPath(std::mt19937_64& generator, const Options& options) {
  Path path;
  Eigen::Vector3d at = Eigen::Vector3d::Zero(), place = at;
  while (static_cast<int>(path.points.size()) < options.steps) {
    if ((place - at).norm() < options.transition) {
      place = inBall(generator, options.length);
      continue;
    }
    at += options.transition * (place - at).normalized();
    path.points.push_back(at);
  }
  path.direction = at;
  return path;
}

/// The paths of one active node. They do not depend on the other selected parts.
std::vector<Path> pathsOf(const Options& options, int axis, std::size_t space) {
  if (options.random == 0) return regularPaths(options);
  std::seed_seq seed = {options.seed, static_cast<unsigned>(axis), static_cast<unsigned>(space)};
  std::mt19937_64 generator(seed);
  std::vector<Path> paths;
  for (int n = 0; n < options.random; ++n) paths.push_back(randomPath(generator, options));
  return paths;
}

Json toJson(const Path& path, const Walked& walked) {
  const auto transitions = static_cast<double>(path.points.size());
  const double way = path.points.front().norm() * transitions;
  const double reached = walked.transitions + walked.failure.step_reached;
  Json json = {{"active", path.node},
               {"direction", {path.direction[0], path.direction[1], path.direction[2]}},
               {"reached_m", walked.complete ? way : way * (reached / transitions)},
               {"smallest_det_F", walked.min_det_F},
               {"detours", walked.detours},
               {"factorizations", walked.cost.factorizations},
               {"newton_iterations", walked.cost.newton_iterations},
               {"seconds", walked.cost.seconds}};
  if (walked.right_inertia) json["right_inertia"] = *walked.right_inertia;
  if (!walked.complete) {
    json["cause"] = name(walked.failure.cause);
    json["element"] = walked.failure.element;
    json["element_det_F"] = walked.failure.element_det_F;
    json["negative_pivots"] = walked.failure.negative_pivots;
    json["expected_negative_pivots"] = walked.failure.expected_negative_pivots;
    json["residual"] = walked.failure.residual;
  }
  return json;
}

/// Counts over all paths.
class Tally {
 public:
  explicit Tally(const Options& options) : options_(options) {}

  void add(const Path& path, const Walked& walked) {
    ++paths_;
    transitions_ += path.points.size();
    seconds_ += walked.cost.seconds;
    factorizations_ += walked.cost.factorizations;
    if (options_.every_path) every_.push_back(toJson(path, walked));
    if (walked.complete) {
      ++complete_;
      straight_ += walked.detours == 0 ? 1 : 0;
      without_inverted_ += walked.min_det_F > 0 ? 1 : 0;
      right_inertia_ += walked.right_inertia.value_or(false) ? 1 : 0;
    } else {
      ++causes_[std::string(name(walked.failure.cause))];
      stopped_.push_back(toJson(path, walked));
    }
    counts_inertia_ |= walked.right_inertia.has_value();
  }

  Json json() const {
    Json result = {
        {"benchmark", "path_survey"},
        {"mesh", options_.mesh.filename().string()},
        {"law", options_.law},
        {"constraint", options_.merely_converged ? "det-F-1" : options_.constraint},
        {"tool", options_.tool},
        {"radius_m", options_.radius},
        {"paths", paths_},
        {"complete", complete_},
        {"complete_without_detours", straight_},
        {"percent", 100.0 * complete_ / paths_},
        {"causes", causes_},
        {"factorizations_per_transition", factorizations_ / static_cast<double>(transitions_)},
        {"seconds", seconds_}};
    if (options_.merely_converged) {
      result["complete_without_inverted_elements"] = without_inverted_;
      result["complete_with_right_inertia"] = counts_inertia_ ? Json(right_inertia_) : Json();
    }
    result["stopped"] = stopped_;
    if (options_.every_path) result["every_path"] = every_;
    return result;
  }

 private:
  const Options& options_;
  int paths_ = 0, complete_ = 0, straight_ = 0, without_inverted_ = 0, right_inertia_ = 0,
      factorizations_ = 0;
  std::size_t transitions_ = 0;
  double seconds_ = 0;
  bool counts_inertia_ = false;
  std::map<std::string, int> causes_;
  Json stopped_ = Json::array(), every_ = Json::array();
};

template <class Walker>
Json survey(const Options& options) {
  Tally tally(options);
  for (const int axis : {0, 1}) {
    const std::string word = axis == 0 ? "x" : "y";
    if (options.axis != "both" && options.axis != word) continue;
    const Problem problem = problemOf(options, axis);
    Walker walker(problem, options);
    for (std::size_t space = 0; space < problem.active.size(); ++space) {
      if (options.only_node >= 0 && options.only_node != static_cast<int>(space)) continue;
      walker.chooseTool(space);
      for (Path& path : pathsOf(options, axis, space)) {
        path.node = fmt::format("{}/{}", word, problem.active[space].name);
        tally.add(path, walker.along(path.points));
      }
    }
  }
  return tally.json();
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) try {
  palpate::Options options;
  CLI::App app(
      "Paths of 100 mm in 26 directions, ten active nodes, two sets of fixed nodes; prints JSON");
  app.add_option("MESH", options.mesh, "A .msh file in metres")->required();
  app.add_option("--law", options.law)
      ->check(
          CLI::IsMember({"mooney-rivlin", "modified-st-venant-kirchhoff", "st-venant-kirchhoff"}));
  app.add_option("--constraint", options.constraint)->check(CLI::IsMember({"ln-det-F", "det-F-1"}));
  app.add_option("--tool", options.tool)
      ->check(CLI::IsMember({"rigid", "weighted-average", "finger"}));
  app.add_option("--radius", options.radius, "Radius of the patch or finger, m; 0: a single node");
  app.add_option("--transition", options.transition, "Distance between configurations, m");
  app.add_option("--nodes", options.nodes, "Active nodes")->check(CLI::PositiveNumber);
  app.add_option("--budget", options.budget, "Factorisations a transition may take");
  app.add_flag("--every-path", options.every_path, "Print every path, not only those that stopped");
  app.add_option("--axis", options.axis, "Only with the body held below 15 % of this axis")
      ->check(CLI::IsMember({"both", "x", "y"}));
  app.add_option("--only-node", options.only_node, "Only from this active node, counted from 0");
  app.add_option("--directions", options.directions, "Number of directions, of 26")
      ->check(CLI::Range(1, 26));
  app.add_option("--random", options.random,
                 "Number of random paths from each node, instead of straight ones; they lead "
                 "through places that are uniform in the ball")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--steps", options.steps, "Transitions of a random path")
      ->check(CLI::PositiveNumber);
  app.add_option("--seed", options.seed, "Seed of the random paths");
  app.add_flag("--fixed-steps", options.fixed_steps, "No step is halved, and there are no detours");
  app.add_flag("--merely-converged", options.merely_converged,
               "As the paper counts: its elements (P1/P1, det F - 1), inverted ones and any "
               "inertia accepted, no detours");
  app.add_option("--iterations", options.iterations,
                 "Limit of Newton's iterations with --merely-converged")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const palpate::Json result = options.merely_converged
                                   ? palpate::survey<palpate::ConvergingWalker>(options)
                                   : palpate::survey<palpate::ValidWalker>(options);
  fmt::print("{}\n", result.dump(1));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "palpate_path_survey: %s\n", error.what());
  return 1;
}
