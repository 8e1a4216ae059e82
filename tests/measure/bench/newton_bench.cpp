// Cost of a Newton iteration, a transition and a path, compared with GetFEM, the finite-element
// library of the 2010 paper, on the same machine in the same minutes. Prints one JSON object,
// described in README.md. Checks nothing, because times depend on the machine.
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/command.hpp"
#include "tests/support/problems.hpp"
#include "tests/support/reference_liver.hpp"
#include "worker/solver/path.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): Fortran's
extern "C" void dgemm_(const char* transpose_a, const char* transpose_b, const int* m, const int* n,
                       const int* k, const double* alpha, const double* a, const int* lda,
                       const double* b, const int* ldb, const double* beta, double* c,
                       const int* ldc);

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

struct Options {
  int rounds = 5;        ///< each: our iterations, then one run of GetFEM
  int repetitions = 20;  ///< of our iteration in each round
  bool without_oracle = false;
  bool coarse_only = false;
  bool laws = false;            ///< measure every law too
  bool paths = false;           ///< measure GetFEM's 10 mm transition and 100 mm path too, which
                                ///< takes minutes
  std::filesystem::path scene;  ///< measure only the iteration of this scene
};

/// Times of one kind of work, seconds.
class Samples {
 public:
  void add(double seconds) { seconds_.push_back(seconds); }
  /// Runs `action` and records its time.
  template <class Action>
  void time(Action&& action) {
    const auto start = Clock::now();
    action();
    add(std::chrono::duration<double>(Clock::now() - start).count());
  }
  double last() const { return seconds_.back(); }
  double best() const { return *std::min_element(seconds_.begin(), seconds_.end()); }
  double median() const {
    std::vector<double> sorted = seconds_;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
  Json milliseconds() const { return {{"best_ms", 1e3 * best()}, {"median_ms", 1e3 * median()}}; }

 private:
  std::vector<double> seconds_;
};

double peakMegabytes() {
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) throw failure("getrusage failed");
  return static_cast<double>(usage.ru_maxrss) / 1024;  // ru_maxrss is in KiB
}

/// GFLOP/s of one dgemm of 1024 x 1024 matrices on one thread, the best of several: the limit of
/// the machine.
double dgemmGflops() {
  constexpr int n = 1024;
  const std::vector<double> a(n * n, 1.5), b(n * n, 0.5);
  std::vector<double> c(n * n);
  const double one = 1, zero = 0;
  Samples samples;
  for (int repetition = 0; repetition < 8; ++repetition)
    samples.time([&] {
      dgemm_("N", "N", &n, &n, &n, &one, a.data(), &n, b.data(), &n, &zero, c.data(), &n);
    });
  return 2e-9 * n * n * n / samples.best();
}

/// A formulation, and the elements of GetFEM for comparison: 0 none, 1 P1/P1, 2 P2/P1.
struct Formulation {
  std::string name;
  Scene scene;
  int oracle_order = 0;
};

Scene withMaterial(Material material, PressureSpace pressure = PressureSpace::p1_stabilized) {
  Scene scene = test::mooneyRivlinScene();
  scene.regions[0].material = std::move(material);
  scene.discretization.pressure = pressure;
  return scene;
}

Scene mooneyRivlin(Discretization discretization) {
  Scene scene = test::mooneyRivlinScene();
  scene.discretization = discretization;
  return scene;
}

/// The default, and the equations that GetFEM solves.
std::vector<Formulation> elementFormulations() {
  return {
      {"mooney-rivlin, P1/P1-stabilized, ln-det-F", mooneyRivlin({}), 1},
      {"mooney-rivlin, P1/P1, det-F-1",
       mooneyRivlin({.pressure = PressureSpace::p1, .constraint = Constraint::det_F_minus_1}), 1},
      {"mooney-rivlin, P2/P1, det-F-1",
       mooneyRivlin({.displacement = DisplacementSpace::p2,
                     .pressure = PressureSpace::p1,
                     .constraint = Constraint::det_F_minus_1}),
       2}};
}

/// Every law, with about the same stiffness.
std::vector<Formulation> lawFormulations() {
  constexpr double mu = 5160;
  Material compressible = {.law = LawName::neo_hookean, .mu = mu};
  compressible.bulk = 1e5;
  return {{"linear, P1", test::youngScene(LawName::linear)},
          {"st-venant-kirchhoff, P1", test::youngScene(LawName::st_venant_kirchhoff)},
          {"modified-st-venant-kirchhoff, P1/P1-stabilized",
           withMaterial({.law = LawName::modified_st_venant_kirchhoff, .young = 3 * mu})},
          {"neo-hookean with bulk, P1", withMaterial(compressible, PressureSpace::none)},
          {"neo-hookean, P1/P1-stabilized", withMaterial({.law = LawName::neo_hookean, .mu = mu})},
          {"yeoh, P1/P1-stabilized",
           withMaterial({.law = LawName::yeoh, .c10 = mu / 2, .c20 = mu / 20, .c30 = mu / 100})},
          {"ogden (3 terms), P1/P1-stabilized",
           withMaterial({.law = LawName::ogden,
                         .ogden = {{0.6 * mu, 1.3}, {0.05 * mu, 5.0}, {-0.485 * mu, -2.0}}})},
          {"veronda-westmann, P1/P1-stabilized",
           withMaterial({.law = LawName::veronda_westmann, .c1 = mu / 2, .c2 = 2})},
          {"holzapfel-gasser-ogden, P1/P1-stabilized",
           withMaterial({.law = LawName::holzapfel_gasser_ogden,
                         .mu = mu,
                         .k1 = mu / 2,
                         .k2 = 1,
                         .fibers = {Eigen::Vector3d::UnitX()}})}};
}

/// The equilibrium 10 mm from rest along x. If one transition does not reach it (a quadratic
/// element beside a single node may fail by the last bits of the kernels), half that distance, and
/// so on.
State nearRest(const Problem& problem) {
  constexpr double least = 1e-4;
  TransitionSolver solver(problem, chooseKernels());
  Failure failure;
  const auto rest = solver.startAtRest(failure);
  if (!rest) throw palpate::failure("{}", describe(failure));
  for (double way = 0.01;; way /= 2) {
    Reached reached = solver.reach(*rest, {way, 0, 0});
    if (reached.outcome.converged()) return std::move(reached.end->state);
    if (way < least) throw palpate::failure("{}", describe(reached.outcome.failure()));
  }
}

/// The parts of one Newton iteration, at the equilibrium 10 mm from rest unless a state is given.
class IterationTimes {
 public:
  explicit IterationTimes(State state = {}) : state_(std::move(state)) {}
  void measure(const Problem& problem, int repetitions) {
    if (state_.u.empty()) state_ = nearRest(problem);
    const System system(problem, chooseKernels());
    std::optional<TangentSolver> analyzed;
    analysis_.time([&] { analyzed.emplace(system); });
    TangentSolver& solver = *analyzed;
    Residual residual;
    Tangent tangent;
    Eigen::MatrixXd step, sensitivity;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
      residual_.time([&] { system.assemble(state_, residual); });
      iteration_.time([&] {
        tangent_.time([&] { system.assemble(state_, residual, tangent); });
        factorize_.time([&] { check(solver.factorize(tangent).ok); });
        step = -residual.free;
        solve_.time([&] { check(solver.solve(step)); });
      });
      sensitivity = -tangent.tool_coupling;
      sensitivity_.time([&] { check(solver.solve(sensitivity)); });
    }
    unknowns_ = system.unknowns();
    flops_ = solver.linearSolver().factorFlops();
    factor_entries_ = solver.linearSolver().factorEntries();
  }
  double best() const { return iteration_.best(); }
  Json json() const {
    return {{"unknowns", unknowns_},
            {"factor_entries", factor_entries_},
            {"assemble_residual", residual_.milliseconds()},
            {"assemble_residual_and_tangent", tangent_.milliseconds()},
            {"factorize", factorize_.milliseconds()},
            {"solve_one", solve_.milliseconds()},
            {"solve_three", sensitivity_.milliseconds()},
            {"analysis_once", analysis_.milliseconds()},
            {"newton_iteration", iteration_.milliseconds()},
            {"factorize_gflops", 1e-9 * flops_ / factorize_.best()}};
  }

 private:
  static void check(bool ok) {
    if (!ok) throw failure("MUMPS failed");
  }
  State state_;
  Samples analysis_, residual_, tangent_, factorize_, solve_, sensitivity_, iteration_;
  int unknowns_ = 0;
  double flops_ = 0, factor_entries_ = 0;
};

/// Walks along x from rest in equal transitions.
class PathTimes {
 public:
  PathTimes(double length, int transitions) : length_(length), transitions_(transitions) {}
  void measure(const Problem& problem) {
    TransitionSolver solver(problem, chooseKernels());
    Failure failure;
    const auto rest = solver.startAtRest(failure);
    if (!rest) throw palpate::failure("{}", describe(failure));
    seconds_.time([&] { path_ = walk(solver, *rest, {length_, 0, 0}, transitions_); });
  }
  double best() const { return seconds_.best(); }
  Json json() const {
    const Cost& cost = path_.outcome.cost;
    Json result = seconds_.milliseconds();
    result["converged"] = path_.outcome.converged();
    result["detours"] = path_.detours;
    result["steps"] = cost.steps;
    result["newton_iterations"] = cost.newton_iterations;
    result["factorizations"] = cost.factorizations;
    return result;
  }

 private:
  double length_;
  int transitions_;
  Samples seconds_;
  Reached path_;
};

/// Configurations one lattice spacing from rest, along the three axes.
class ConfigurationTimes {
 public:
  void measure(const Problem& problem) {
    constexpr double spacing = 0.02;
    TransitionSolver solver(problem, chooseKernels());
    Failure failure;
    const auto rest = solver.startAtRest(failure);
    if (!rest) throw palpate::failure("{}", describe(failure));
    failed_ = 0;
    total_ = {};
    seconds_.time([&] {
      for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {-1.0, 1.0}) {
          const Outcome outcome =
              solver.reach(*rest, sign * spacing * Eigen::Vector3d::Unit(axis)).outcome;
          failed_ += outcome.converged() ? 0 : 1;
          total_.newton_iterations += outcome.cost.newton_iterations;
          total_.factorizations += outcome.cost.factorizations;
        }
    });
  }
  Json json() const {
    return {{"configurations", count},
            {"failed", failed_},
            {"factorizations_per_configuration", 1.0 * total_.factorizations / count},
            {"newton_iterations_per_configuration", 1.0 * total_.newton_iterations / count},
            {"seconds_per_configuration", seconds_.best() / count}};
  }

 private:
  static constexpr int count = 6;
  Samples seconds_;
  Cost total_;
  int failed_ = 0;
};

/// GetFEM with the constraint det F - 1 and Mooney-Rivlin.
class Oracle {
 public:
  Oracle(std::filesystem::path mesh, int order) : mesh_(std::move(mesh)), order_(order) {}
  void measureIteration() {
    // A nearly zero displacement: only the assembly and the linear solve are measured.
    const Json answer = run(1e-6, 1);
    assembly_.add(answer.at("assembly_s"));
    solve_.add(answer.at("solve_s"));
    iteration_.add(assembly_.last() + solve_.last());
  }
  void measurePaths() {
    transition_ = path(0.01, 1);
    path_ = path(0.1, 20);
  }
  double best() const { return iteration_.best(); }
  std::optional<double> transitionSeconds() const { return secondsOf(transition_); }
  std::optional<double> pathSeconds() const { return secondsOf(path_); }
  Json json() const {
    Json result = {{"assembly", assembly_.milliseconds()},
                   {"solve", solve_.milliseconds()},
                   {"newton_iteration", iteration_.milliseconds()}};
    if (transition_) result["transition_10mm"] = *transition_;
    if (path_) result["path_100mm_in_20_steps"] = *path_;
    return result;
  }

 private:
  Json run(double length, int steps) const {
    const Eigen::Vector3d& tip = test::liver_tip;
    const auto result = test::runCommand(fmt::format(
        "/usr/bin/python3 '{}/oracle/getfem_reference.py' '{}' --law mr --fixed-below x 0.15 "
        "--active {} {} {} --to {} 0 0 --steps {} --order {}",
        PALPATE_REFERENCE_DATA, mesh_.string(), tip[0], tip[1], tip[2], length, steps, order_));
    if (result.exit_code != 0)
      throw failure("GetFEM ended with {} (is python3-getfem installed?):\n{}", result.exit_code,
                    result.output);
    return Json::parse(result.output);
  }
  static std::optional<double> secondsOf(const std::optional<Json>& path) {
    if (!path || !path->contains("seconds")) return std::nullopt;
    return path->at("seconds").get<double>();
  }
  /// GetFEM does not always complete long paths; that is a result too.
  Json path(double length, int steps) const {
    Json answer;
    try {
      answer = run(length, steps);
    } catch (const std::exception& error) {
      return {{"converged", false}, {"error", error.what()}};
    }
    int iterations = 0;
    bool converged = true;
    for (const Json& step : answer.at("steps")) {
      iterations += step.at("iterations").get<int>();
      converged &= step.at("converged").get<bool>();
    }
    return {{"seconds", answer.at("total_s")},
            {"converged", converged},
            {"newton_iterations", iterations}};
  }

  std::filesystem::path mesh_;
  int order_;
  Samples assembly_, solve_, iteration_;
  std::optional<Json> transition_, path_;
};

/// All measurements of one mesh. `shipped`: the mesh comes with the project and is not measured
/// with GetFEM.
Json measureMesh(const Mesh& mesh, const std::filesystem::path& file, bool shipped, bool coarse,
                 const Options& options) {
  std::vector<Formulation> formulations = elementFormulations();
  if (!coarse) formulations.pop_back();  // GetFEM takes minutes for an iteration of P2/P1
  if (options.laws)
    for (Formulation& formulation : lawFormulations())
      formulations.push_back(std::move(formulation));
  std::vector<Problem> problems;
  for (const Formulation& formulation : formulations)
    problems.push_back(test::liverProblem(formulation.scene, mesh));
  std::vector<IterationTimes> iterations(formulations.size());
  std::vector<ConfigurationTimes> configurations(formulations.size());
  std::vector<PathTimes> transitions(formulations.size(), {0.01, 1}),
      paths(formulations.size(), {0.1, 5});
  double peak_megabytes = 0;
  std::map<int, Oracle> oracles;
  if (!options.without_oracle && !shipped)
    for (const int order : coarse ? std::vector{1, 2} : std::vector{1})
      oracles.emplace(order, Oracle(file, order));
  for (int round = 0; round < options.rounds; ++round) {
    for (std::size_t n = 0; n < formulations.size(); ++n) {
      iterations[n].measure(problems[n], options.repetitions);
      configurations[n].measure(problems[n]);
      transitions[n].measure(problems[n]);
      if (formulations[n].oracle_order == 1) paths[n].measure(problems[n]);
      // A worker solves one formulation; later ones only add the memory that the allocator keeps.
      if (peak_megabytes == 0) peak_megabytes = peakMegabytes();
    }
    for (auto& [order, oracle] : oracles) oracle.measureIteration();
  }
  if (options.paths && oracles.contains(1)) oracles.at(1).measurePaths();

  Json result = {{"mesh", file.filename().string()},
                 {"nodes", mesh.nodes.size()},
                 {"tetrahedra", mesh.tetrahedra.size()},
                 {"peak_rss_mb", peak_megabytes}};
  for (std::size_t n = 0; n < formulations.size(); ++n) {
    const int order = formulations[n].oracle_order;
    Json& ours = result["palpate"][formulations[n].name] = iterations[n].json();
    ours["lattice_configurations_20mm"] = configurations[n].json();
    ours["transition_10mm"] = transitions[n].json();
    if (order == 1) ours["path_100mm_in_5_transitions"] = paths[n].json();
    if (!oracles.contains(order)) continue;
    const Oracle& oracle = oracles.at(order);
    ours["newton_iteration_times_faster"] = oracle.best() / iterations[n].best();
    if (const auto seconds = oracle.transitionSeconds())
      ours["transition_10mm_times_faster"] = *seconds / transitions[n].best();
    if (const auto seconds = oracle.pathSeconds())
      ours["path_100mm_times_faster"] = *seconds / paths[n].best();
  }
  for (const auto& [order, oracle] : oracles)
    result["getfem"][order == 1 ? "P1/P1" : "P2/P1"] = oracle.json();
  return result;
}

/// The predicted state for a step of 1 mm along x. A quadratic element beside a single node may not
/// reach its end, but the first iteration costs as much as any other.
State predictedState(const Problem& problem) {
  TransitionSolver solver(problem, chooseKernels());
  Failure failure;
  const auto rest = solver.startAtRest(failure);
  if (!rest) throw palpate::failure("{}", describe(failure));
  const Eigen::Vector3d way(0.001, 0, 0);
  return solver.system().moved(rest->state, rest->sensitivity * way, 1, way);
}

/// Only the iteration, for any scene, at its first active node.
Json measureScene(const Options& options) {
  const Problem problem = loadProblem(options.scene);
  IterationTimes iteration(predictedState(problem));
  for (int round = 0; round < options.rounds; ++round)
    iteration.measure(problem, options.repetitions);
  Json result = {{"benchmark", "newton"},
                 {"scene", problem.scene.name},
                 {"kernels", chooseKernels().family},
                 {"nodes", problem.mesh.vertices()},
                 {"tetrahedra", problem.mesh.tetrahedra.size()}};
  result.update(iteration.json());
  return result;
}

std::string cpuModel() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

double load() {
  double average = -1;
  getloadavg(&average, 1);
  return average;
}

int runBenchmark(const Options& options) {
  if (!options.scene.empty()) {
    fmt::print("{}\n", measureScene(options).dump(1));
    return 0;
  }
  const std::filesystem::path reference = PALPATE_REFERENCE_DATA, source = PALPATE_SOURCE_DIR;
  const bool shipped = !std::filesystem::exists(reference / "meshes/liver-493.msh");
  Json result = {
      {"benchmark", "newton"},
      {"cpu", cpuModel()},
      {"kernels", chooseKernels().family},
      {"load_average_before", load()},
      {"note", "best of all rounds on both sides, one thread; other processes disturb the median"}};
  for (const bool coarse : {true, false}) {
    if (options.coarse_only && !coarse) continue;
    const std::filesystem::path file =
        shipped ? source / "deploy/scenes/liver" / (coarse ? "liver-500.msh" : "liver-2000.msh")
                : reference / "meshes" / (coarse ? "liver-493.msh" : "liver-2228.msh");
    result["meshes"].push_back(measureMesh(readGmsh(file), file, shipped, coarse, options));
  }
  result["dgemm_gflops"] = dgemmGflops();
  result["load_average_after"] = load();
  fmt::print("{}\n", result.dump(1));
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) try {
  palpate::Options options;
  CLI::App app(
      "One Newton iteration, a transition and a path on two livers, beside GetFEM's; prints JSON");
  app.add_option("--rounds", options.rounds, "Rounds, each with one run of GetFEM")
      ->check(CLI::PositiveNumber);
  app.add_option("--repetitions", options.repetitions, "Our Newton iterations in a round")
      ->check(CLI::PositiveNumber);
  app.add_flag("--without-oracle", options.without_oracle, "Do not run GetFEM");
  app.add_flag("--coarse-only", options.coarse_only, "Leave out the mesh of 2228 nodes");
  app.add_flag("--laws", options.laws, "Every law, not only Mooney-Rivlin");
  app.add_flag("--paths", options.paths,
               "Measure GetFEM's 10 mm transition and 100 mm path too (minutes)");
  app.add_option("--scene", options.scene, "The Newton iteration of this scene file alone")
      ->check(CLI::ExistingFile);
  app.footer(
      "newton_iteration: one assembly of residual and tangent, one factorisation and one\n"
      "  solve, on one thread, at the equilibrium 10 mm from rest (or at half of that, and\n"
      "  so on, if the solver does not reach it). GetFEM analyses the matrix in every\n"
      "  iteration.\n"
      "newton_iteration_times_faster: best time of GetFEM divided by the best time of\n"
      "  Palpate. Palpate has repetitions x rounds samples, GetFEM one a round, so a busy\n"
      "  machine favours Palpate; increase --rounds there.\n"
      "P1/P1, det-F-1 and P2/P1, det-F-1: GetFEM's equations. P1/P1-stabilized, ln-det-F:\n"
      "  the default.\n"
      "lattice_configurations_20mm: six configurations one spacing from rest, without the\n"
      "  factorisation of the start.\n"
      "factorize_gflops: limited by dgemm_gflops. peak_rss_mb: of the process, at this\n"
      "  mesh.");
  CLI11_PARSE(app, argc, argv);
  return palpate::runBenchmark(options);
} catch (const std::exception& error) {
  std::fprintf(stderr, "palpate_newton_bench: %s\n", error.what());
  return 1;
}
