// What one Newton iteration, a transition and a path cost, beside GetFEM, the finite-element library of the
// 2010 paper, on the same machine in the same minutes. Prints one JSON object; README.md says what it means.
// Nothing here is checked: times belong to the machine.
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/command.hpp"
#include "tests/support/problems.hpp"
#include "tests/support/reference_liver.hpp"
#include "worker/transition.hpp"

extern "C" void dgemm_(const char* transpose_a, const char* transpose_b, const int* m, const int* n,
                       const int* k, const double* alpha, const double* a, const int* lda, const double* b,
                       const int* ldb, const double* beta, double* c, const int* ldc);

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

struct Options {
  int rounds = 5;        ///< each: our iterations, then one run of GetFEM
  int repetitions = 20;  ///< of our iteration in a round
  bool without_oracle = false;
  bool paths = false;  ///< GetFEM's 10 mm transition and 100 mm path too: minutes
};

/// Times of one thing, seconds.
class Samples {
 public:
  void add(double seconds) { seconds_.push_back(seconds); }
  /// Runs `action` and takes its time.
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

/// GFLOP/s of one dgemm of 1024 x 1024 matrices on one thread, the best of some: what the machine can do at
/// most.
double dgemmGflops() {
  constexpr int n = 1024;
  const std::vector<double> a(n * n, 1.5), b(n * n, 0.5);
  std::vector<double> c(n * n);
  const double one = 1, zero = 0;
  Samples samples;
  for (int repetition = 0; repetition < 8; ++repetition)
    samples.time(
        [&] { dgemm_("N", "N", &n, &n, &n, &one, a.data(), &n, b.data(), &n, &zero, c.data(), &n); });
  return 2e-9 * n * n * n / samples.best();
}

struct Formulation {
  const char* name;
  Discretization discretization;
};

/// The default, and the equations that GetFEM solves.
const std::vector<Formulation> formulations = {
    {"P1-stabilized, ln-det-F",
     {.pressure = PressureSpace::p1_stabilized, .constraint = Constraint::ln_det_F}},
    {"P1, det-F-1", {.pressure = PressureSpace::p1, .constraint = Constraint::det_F_minus_1}}};

State stateAt(const Problem& problem, const Eigen::Vector3d& displacement) {
  TransitionSolver solver(problem, chooseKernels());
  Failure failure;
  const auto rest = solver.startAtRest(failure);
  if (!rest) throw palpate::failure("{}", describe(failure));
  Reached reached = solver.reach(*rest, displacement);
  if (!reached.outcome.converged) throw palpate::failure("{}", describe(reached.outcome.failure));
  return std::move(reached.end.state);
}

/// The parts of one Newton iteration, at the equilibrium 10 mm from rest.
class IterationTimes {
 public:
  void measure(const Problem& problem, int repetitions) {
    if (state_.u.empty()) state_ = stateAt(problem, {0.01, 0, 0});
    const System system(problem, chooseKernels());
    TangentSolver solver(system);
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
            {"newton_iteration", iteration_.milliseconds()},
            {"factorize_gflops", 1e-9 * flops_ / factorize_.best()}};
  }

 private:
  static void check(bool ok) {
    if (!ok) throw failure("MUMPS failed");
  }
  State state_;
  Samples residual_, tangent_, factorize_, solve_, sensitivity_, iteration_;
  int unknowns_ = 0;
  double flops_ = 0, factor_entries_ = 0;
};

/// Equal transitions along x from rest.
class PathTimes {
 public:
  PathTimes(double length, int transitions) : length_(length), transitions_(transitions) {}
  void measure(const Problem& problem) {
    TransitionSolver solver(problem, chooseKernels());
    Failure failure;
    const auto rest = solver.startAtRest(failure);
    if (!rest) throw palpate::failure("{}", describe(failure));
    cost_ = {};
    reached_ = 0;
    seconds_.time([&] {
      Start at = *rest;
      for (int n = 1; n <= transitions_; ++n) {
        Reached reached = solver.reach(at, {length_ * n / transitions_, 0, 0});
        cost_.newton_iterations += reached.outcome.cost.newton_iterations;
        cost_.factorizations += reached.outcome.cost.factorizations;
        cost_.steps += reached.outcome.cost.steps;
        if (!reached.outcome.converged) return;
        ++reached_;
        at = std::move(reached.end);
      }
    });
  }
  double best() const { return seconds_.best(); }
  bool converged() const { return reached_ == transitions_; }
  Json json() const {
    Json result = seconds_.milliseconds();
    result["converged"] = converged();
    result["transitions"] = reached_;
    result["steps"] = cost_.steps;
    result["newton_iterations"] = cost_.newton_iterations;
    result["factorizations"] = cost_.factorizations;
    return result;
  }

 private:
  double length_;
  int transitions_;
  Samples seconds_;
  Cost cost_;
  int reached_ = 0;
};

/// GetFEM, which solves "P1, det-F-1".
class Oracle {
 public:
  explicit Oracle(std::filesystem::path mesh) : mesh_(std::move(mesh)) {}
  void measureIteration() {
    // A displacement of nothing: only its assembly and its linear solve are looked at.
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
    const auto result = test::runCommand(
        fmt::format("/usr/bin/python3 '{}/oracle/getfem_reference.py' '{}' --law mr --fixed-below x 0.15 "
                    "--active {} {} {} --to {} 0 0 --steps {}",
                    PALPATE_REFERENCE_DATA, mesh_.string(), tip[0], tip[1], tip[2], length, steps));
    if (result.exit_code != 0)
      throw failure("GetFEM ended with {} (is python3-getfem installed?):\n{}", result.exit_code,
                    result.output);
    return Json::parse(result.output);
  }
  static std::optional<double> secondsOf(const std::optional<Json>& path) {
    if (!path) return std::nullopt;
    return path->at("seconds").get<double>();
  }
  Json path(double length, int steps) const {
    const Json answer = run(length, steps);
    int iterations = 0;
    bool converged = true;
    for (const Json& step : answer.at("steps")) {
      iterations += step.at("iterations").get<int>();
      converged &= step.at("converged").get<bool>();
    }
    return {{"seconds", answer.at("total_s")}, {"converged", converged}, {"newton_iterations", iterations}};
  }

  std::filesystem::path mesh_;
  Samples assembly_, solve_, iteration_;
  std::optional<Json> transition_, path_;
};

/// Everything about one mesh.
Json measureMesh(const std::filesystem::path& mesh, const std::optional<Problem>& shipped,
                 const Options& options) {
  std::vector<Problem> problems;
  for (const Formulation& formulation : formulations) {
    Scene scene = test::mooneyRivlinScene();
    scene.discretization = formulation.discretization;
    problems.push_back(shipped ? *shipped : test::liverProblem(std::move(scene), mesh));
    problems.back().scene.discretization = formulation.discretization;
  }
  std::vector<IterationTimes> iterations(formulations.size());
  std::vector<PathTimes> transitions(formulations.size(), {0.01, 1}), paths(formulations.size(), {0.1, 5});
  double peak_megabytes = 0;
  std::optional<Oracle> oracle;
  if (!options.without_oracle && !shipped) oracle.emplace(mesh);
  for (int round = 0; round < options.rounds; ++round) {
    for (std::size_t n = 0; n < formulations.size(); ++n) {
      iterations[n].measure(problems[n], options.repetitions);
      transitions[n].measure(problems[n]);
      paths[n].measure(problems[n]);
      // A worker solves one formulation; later ones only add what the allocator keeps.
      if (peak_megabytes == 0) peak_megabytes = peakMegabytes();
    }
    if (oracle) oracle->measureIteration();
  }
  if (oracle && options.paths) oracle->measurePaths();

  Json result = {{"mesh", mesh.filename().string()},
                 {"nodes", problems[0].mesh.nodes.size()},
                 {"tetrahedra", problems[0].mesh.tetrahedra.size()},
                 {"peak_rss_mb", peak_megabytes}};
  for (std::size_t n = 0; n < formulations.size(); ++n) {
    Json& ours = result["palpate"][formulations[n].name] = iterations[n].json();
    ours["transition_10mm"] = transitions[n].json();
    ours["path_100mm_in_5_transitions"] = paths[n].json();
    if (oracle) ours["newton_iteration_times_faster"] = oracle->best() / iterations[n].best();
    if (oracle && oracle->transitionSeconds()) {
      ours["transition_10mm_times_faster"] = *oracle->transitionSeconds() / transitions[n].best();
      ours["path_100mm_times_faster"] = *oracle->pathSeconds() / paths[n].best();
    }
  }
  if (oracle) result["getfem"] = oracle->json();
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
  const std::filesystem::path reference = PALPATE_REFERENCE_DATA, source = PALPATE_SOURCE_DIR;
  const bool shipped = !std::filesystem::exists(reference / "meshes/liver-493.msh");
  Json result = {
      {"benchmark", "newton"},
      {"cpu", cpuModel()},
      {"kernels", chooseKernels().family},
      {"load_average_before", load()},
      {"note", "best of all rounds on both sides, one thread; other processes disturb the median"}};
  for (const char* name : {"493", "2228"}) {
    if (shipped) {
      const bool coarse = std::string_view(name) == "493";
      const Problem problem =
          loadProblem(source / "deploy/scenes/liver" / (coarse ? "liver.toml" : "liver-2000.toml"));
      result["meshes"].push_back(measureMesh(problem.scene.mesh, problem, options));
    } else {
      result["meshes"].push_back(
          measureMesh(reference / fmt::format("meshes/liver-{}.msh", name), std::nullopt, options));
    }
  }
  result["dgemm_gflops"] = dgemmGflops();
  result["load_average_after"] = load();
  fmt::print("{}\n", result.dump(1));
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  palpate::Options options;
  CLI::App app("One Newton iteration, a transition and a path on two livers, beside GetFEM's; prints JSON");
  app.add_option("--rounds", options.rounds, "Rounds, each with one run of GetFEM")
      ->check(CLI::PositiveNumber);
  app.add_option("--repetitions", options.repetitions, "Our Newton iterations in a round")
      ->check(CLI::PositiveNumber);
  app.add_flag("--without-oracle", options.without_oracle, "Do not run GetFEM");
  app.add_flag("--paths", options.paths, "Measure GetFEM's 10 mm transition and 100 mm path too (minutes)");
  CLI11_PARSE(app, argc, argv);
  try {
    return palpate::runBenchmark(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "palpate_newton_bench: {}\n", error.what());
    return 1;
  }
}
