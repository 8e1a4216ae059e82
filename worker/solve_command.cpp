#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/base/assertion.hpp"
#include "common/base/displacement_input.hpp"
#include "common/base/number_text.hpp"
#include "common/base/required_option.hpp"
#include "common/mesh/surface_point.hpp"
#include "common/problem/finger.hpp"
#include "common/problem/problem_warnings.hpp"
#include "common/scene/active_choice.hpp"
#include "worker/solver/path.hpp"
#include "worker/verbs.hpp"

namespace palpate {
namespace {

struct SolveOptions {
  std::string scene;
  std::string active;
  std::vector<std::string> at, displacement;
  std::vector<double> hold;
  std::optional<int> steps;
  bool json = false;

  void addTo(CLI::App& app) {
    addRequired(app, "SCENE", scene, "The scene, a TOML file (docs/scene.md)", "FILE");
    app.add_option("--active", active,
                   "Active node, or surface that a finger touches; not needed if there is only one")
        ->type_name("NAME");
    addPlaceOption(app, at);
    addDisplacementOption(app, displacement);
    app.add_option(
           "--hold", hold,
           "Place and displacement of a second finger that holds the body, m: it comes first")
        ->expected(6)
        ->type_name("X Y Z DX DY DZ");
    app.add_option("--steps", steps, "Number of equal steps from rest [one per lattice spacing]")
        ->check(CLI::Range(1, 100000));
    app.add_flag("--json", json, "One JSON object per line (docs/commands.md)");
    app.footer(
        "Prints the force on the tool in N, the stiffness d force / d displacement in N/m and the\n"
        "energy in J.\n"
        "Exit codes: 0 done, 1 failed, 2 wrong usage or scene, 3 a displacement was not reached "
        "(the\n"
        "output gives the reason), 130 interrupted.");
  }
};

/// Solves along the straight path from `start` to `target`; by default with one transition per
/// lattice spacing. A `start` of nullopt has the failure `why`.
Reached solveFrom(TransitionSolver& solver, const Problem& problem, std::optional<int> steps,
                  const std::optional<Start>& start, const Failure& why,
                  const Eigen::Vector3d& target) {
  PALPATE_ASSERT(!steps || *steps > 0, "--steps must be positive");
  if (!start) return {{why, {}}};
  const double spacings =
      (target - start->state.displacement).norm() / problem.scene.workspace.spacing;
  Reached reached = walk(solver, *start, target,
                         steps.value_or(std::max(1, static_cast<int>(std::ceil(spacings - 1e-9)))));
  ++reached.outcome.cost.factorizations;  // the one of the start
  return reached;
}

/// Solves for given displacements of the scene's tool. A finger can be moved between two solves.
class Solving {
 public:
  Solving(const SolveOptions& options, const Problem& problem)
      : options_(options),
        problem_(problem),
        chosen_(chooseActive(problem.scene, options.active)),
        solver_(problem, chooseKernels()) {
    requirePlace(chosen_, !options.at.empty());
    solver_.chooseTool(chosen_.spaces.front());
    if (finger()) place_ = finger()->center;
    if (!options.hold.empty() && !finger())
      throw badInput("--hold needs a finger, but {} is none", chosen_.name);
    if (!std::ranges::all_of(options.hold, [](double x) { return std::isfinite(x); }))
      throw badInput("--hold: all numbers must be finite");
  }

  /// Returns the position of the finger; nullopt for other tools.
  const std::optional<Eigen::Vector3d>& place() const { return place_; }

  /// Moves the finger to the point of the surface nearest to `near`.
  void moveTo(const Eigen::Vector3d& near) {
    PALPATE_ASSERT(finger().has_value(), "only a finger can move along the surface");
    const Finger moved = fingerNear("--at", problem_.mesh, near, finger()->radius);
    if (const double distance = (moved.center - near).norm();
        distance > mostPlaceDistance(problem_.mesh, moved.radius))
      spdlog::warn(
          "--at is {:.4g} m away from the surface; the finger is at the nearest surface point",
          distance);
    if (place_ == moved.center) return;
    place_.reset();  // until the finger is placed
    solver_.placeFinger("--at", moved);
    place_ = moved.center;
  }

  Reached at(const Eigen::Vector3d& displacement) {
    refuseMistakenUnit(problem_.mesh, displacement);
    Failure failure;
    std::optional<Start> start;
    Cost spent;
    if (options_.hold.empty()) {
      start = solver_.startAtRest(failure);
    } else {
      Reached held = hold();
      spent = held.outcome.cost;
      if (!held.outcome.converged()) return held;
      start = solver_.hold(*held.end, {place_.value(), finger()->radius}, failure);
    }
    Reached reached = solveFrom(solver_, problem_, options_.steps, start, failure, displacement);
    reached.outcome.cost += spent;
    return reached;
  }

 private:
  /// Presses the second finger into the body alone.
  Reached hold() {
    const Eigen::Vector3d near(options_.hold.data()), displacement(options_.hold.data() + 3);
    refuseMistakenUnit(problem_.mesh, displacement);
    solver_.letGo();
    solver_.placeFinger("--hold", fingerNear("--hold", problem_.mesh, near, finger()->radius));
    Failure failure;
    const auto rest = solver_.startAtRest(failure);
    return solveFrom(solver_, problem_, options_.steps, rest, failure, displacement);
  }

  const std::optional<Finger>& finger() const {
    return problem_.active[chosen_.spaces.front()].finger;
  }

  const SolveOptions& options_;
  const Problem& problem_;
  const ActiveChoice chosen_;
  TransitionSolver solver_;
  std::optional<Eigen::Vector3d> place_;
};

nlohmann::ordered_json toJson(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

void printJson(const Mesh& mesh, const std::optional<Eigen::Vector3d>& place,
               const Eigen::Vector3d& displacement, const Reached& reached) {
  using nlohmann::ordered_json;
  const Outcome& outcome = reached.outcome;
  const bool found = outcome.converged();
  const Equilibrium e = found ? outcome.equilibrium() : Equilibrium();
  const auto orNull = [](bool known, const ordered_json& value) { return known ? value : nullptr; };
  const ordered_json rows = {toJson(e.stiffness.row(0)), toJson(e.stiffness.row(1)),
                             toJson(e.stiffness.row(2))};
  ordered_json answer = {{"displacement", toJson(displacement)},
                         {"converged", found},
                         {"force", orNull(found, toJson(e.force))},
                         {"stiffness", orNull(found, rows)},
                         {"energy", orNull(found, e.energy)},
                         {"newton_iterations", outcome.cost.newton_iterations},
                         {"factorizations", outcome.cost.factorizations},
                         {"seconds", outcome.cost.seconds},
                         {"min_det_F", found ? e.min_det_F : outcome.failure().element_det_F},
                         {"failure", nullptr}};
  if (!found) answer["failure"] = std::string(name(outcome.failure().cause));
  if (place) {
    answer["at"] = toJson(*place);
    answer["drive"] = orNull(found, toJson(alongSurface(mesh, *place, e.drive)));
  }
  if (reached.held) answer["hold_force"] = orNull(found, toJson(reached.held->force.head<3>()));
  fmt::print("{}\n", answer.dump());
}

void printText(const Mesh& mesh, const std::optional<Eigen::Vector3d>& place,
               const Eigen::Vector3d& displacement, const Reached& reached) {
  const Outcome& outcome = reached.outcome;
  if (place) fmt::print("at            {} m\n", vectorText(*place, 6, " "));
  fmt::print("displacement  {} m\n", vectorText(displacement, 6, " "));
  if (!outcome.converged()) {
    fmt::print("failed        {}\n", describe(outcome.failure()));
  } else {
    const Equilibrium& e = outcome.equilibrium();
    fmt::print("force on tool {} N   ({:.6g} N)\n", vectorText(e.force, 6, " "), e.force.norm());
    for (int row = 0; row < 3; ++row)
      fmt::print("{}{:12.5g} {:12.5g} {:12.5g}\n", row == 0 ? "stiffness N/m" : "             ",
                 e.stiffness(row, 0) + 0.0, e.stiffness(row, 1) + 0.0, e.stiffness(row, 2) + 0.0);
    if (place)
      fmt::print("drive         {} N, along the surface\n",
                 vectorText(alongSurface(mesh, *place, e.drive), 6, " "));
    if (reached.held)
      fmt::print("force on hold {} N   ({:.6g} N)\n",
                 vectorText(reached.held->force.head<3>(), 6, " "),
                 reached.held->force.head<3>().norm());
    fmt::print("energy        {:.6g} J\nmin det F     {:.4g}\n", e.energy, e.min_det_F);
  }
  fmt::print("cost          {}, {}, {:.3f} s\n",
             counted(outcome.cost.newton_iterations, "Newton iteration"),
             counted(outcome.cost.factorizations, "factorisation"), outcome.cost.seconds);
}

/// Prints the answer to an input line that cannot be solved, with the reason. It has the same keys
/// as other answers.
void printRefusal(const TouchInput& touch, const char* why, bool json) {
  const Eigen::Vector3d& d = touch.displacement;
  if (json) {
    nlohmann::ordered_json answer = {
        {"displacement", toJson(d)}, {"converged", false}, {"force", nullptr},
        {"stiffness", nullptr},      {"energy", nullptr},  {"newton_iterations", 0},
        {"factorizations", 0},       {"seconds", 0},       {"min_det_F", nullptr},
        {"failure", "refused"},      {"why", why}};
    if (touch.at) answer.update({{"at", toJson(*touch.at)}, {"drive", nullptr}});
    fmt::print("{}\n", answer.dump());
    return;
  }
  if (touch.at) fmt::print("at            {} m\n", vectorText(*touch.at, 6, " "));
  fmt::print("displacement  {} m\nfailed        refused: {}\n", vectorText(d, 6, " "), why);
}

ExitCode solve(const SolveOptions& options) {
  const Problem problem = loadProblem(options.scene);
  logWarnings(problem);
  Solving solving(options, problem);
  bool all_converged = true;
  const double radius = problem.scene.workspace.radius;
  const bool of_many = options.displacement == from_input;
  forEachTouch(options.at, options.displacement, std::cin, radius, [&](const TouchInput& touch) {
    try {
      if (touch.at) solving.moveTo(*touch.at);
      const Reached reached = solving.at(touch.displacement);
      all_converged &= reached.outcome.converged();
      (options.json ? printJson : printText)(problem.mesh, solving.place(), touch.displacement,
                                             reached);
    } catch (const Error& error) {
      if (!of_many || error.exitCode() != ExitCode::usage) throw;
      all_converged = false;
      printRefusal(touch, error.what(), options.json);
    }
    std::fflush(stdout);  // a program that pipes displacements in waits for each answer
  });
  return all_converged ? ExitCode::done : ExitCode::partly_failed;
}

}  // namespace

const Verb solve_verb = {"solve", "Exact solutions at given displacements, without a scheduler",
                         prepareVerb<SolveOptions, solve>};

}  // namespace palpate
