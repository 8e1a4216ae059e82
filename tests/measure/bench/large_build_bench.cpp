// Cost of a build with very many results for its scheduler. Makes a state directory with this many
// small results (journal and tables by the real code), then measures each part of a restart in a
// separate process, the cost of a status and of a forecast, and sealing.
// Prints one JSON object. Checks nothing, because times depend on the machine and its disk.
//
//   palpate_large_build_bench [--results 100000] [--spaces 20] [--directory DIR] [--keep]
//     [--without-seal]

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "scheduler/builds/build.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Options {
  double results = 1e5;
  int spaces = 20;
  std::string directory;
  bool keep = false, without_seal = false;
};

/// A cube of at least 8 nodes with the requested number of active nodes, and a lattice with about
/// the requested number of points around each.
Problem problemOf(const Options& options) {
  Scene scene;
  scene.name = "large";
  scene.mesh = "cube.msh";
  scene.regions[0].material.c10 = 1300;
  scene.regions[0].material.c01 = 1280;
  scene.fixed.half_spaces = {{0, true, 0.15, std::nullopt}};
  int cells = 1;
  while (cells * (cells + 1) * 4 < options.spaces) ++cells;
  Mesh mesh = test::cubeMesh(0.1, cells);
  for (const std::int32_t node : surfaceNodes(mesh))
    if (mesh.nodes[static_cast<std::size_t>(node)].x() > 0.02 &&
        std::ssize(scene.active) < options.spaces)
      scene.active.push_back({.name = fmt::format("skin-{}", node), .node = node});
  const double each = options.results / static_cast<double>(scene.active.size());
  const double ratio = std::max(1.0, std::cbrt(each * 3 / (4 * M_PI)));
  // Slightly off whole numbers, which spacings would be rounded to.
  scene.workspace = {0.05, 0.05 / ratio, 100, true};
  return resolve(std::move(scene), std::move(mesh));
}

/// The answer of a worker for a linear body, except for the bits of its fields: one branch,
/// everything converges.
class LinearBody {
 public:
  explicit LinearBody(const Problem& problem) : problem_(problem) {
    header_.set_build(std::string(problemId(problem).bytes()));
    header_.set_kernel_family("avx2/Haswell");
    wire::Provenance& giver = *header_.mutable_given_by();
    giver.set_worker(std::string(16, 'w'));
    giver.set_host("compute-17.cluster");
    giver.set_key(std::string(32, 'k'));
    fields_.displacement.resize(3 * problem.mesh.nodes.size());
    fields_.pressure.resize(problem.pressures.count());
  }

  std::pair<const wire::Result&, std::string> solve(const SpacePlan& plan, std::uint32_t space,
                                                    const Transition& transition) {
    constexpr double stiffness = 50;  // N/m
    const Lattice& positions = plan.positions();
    const Eigen::Vector3d p = positions.displacement(transition.target);
    Configuration found;
    found.equilibrium.force = -stiffness * p;
    found.equilibrium.stiffness = -stiffness * Eigen::Matrix3d::Identity();
    found.equilibrium.energy = stiffness / 2 * p.squaredNorm();
    found.equilibrium.min_det_F = 0.97;
    found.residual = 1.25e-9;
    for (std::size_t n = 0; n < problem_.mesh.nodes.size(); ++n)
      for (std::size_t i = 0; i < 3; ++i)
        fields_.displacement[3 * n + i] =
            static_cast<float>(p[static_cast<Eigen::Index>(i)] * problem_.mesh.nodes[n].x() / 0.1);
    std::string payload = fields_.encode();
    header_.set_space(space);
    *header_.mutable_target() = toWire(positions.point(transition.target));
    *header_.mutable_parent() = toWire(positions.point(transition.parent));
    header_.set_start_id(startIdOf(plan, transition));
    header_.set_steps(static_cast<std::uint32_t>(plan.stepsOf(transition)));
    if (transition.target != transition.parent)
      *header_.mutable_start_parent() = toWire(positions.point(transition.parent));
    toWire({std::move(found), {3, 1, 1, 0.0125}}, payload, header_);
    return {header_, std::move(payload)};
  }

 private:
  const Problem& problem_;
  wire::Result header_;
  NodalFields fields_;
};

/// Records the results that the plans request, in turns of all spaces, until `but` results are
/// missing.
std::int64_t record(const Problem& problem, JobStore& store, std::vector<SpacePlan>& plans,
                    const std::vector<ResultKey>& asked, std::int64_t but) {
  LinearBody body(problem);
  std::int64_t left = 0;
  for (const SpacePlan& plan : plans)
    left += plan.points().uniform().of(Tag::unknown) - but / std::ssize(plans);
  std::int64_t results = 0;
  const auto solve = [&](std::uint32_t space, const Transition& transition) {
    const auto [header, payload] = body.solve(plans[space], space, transition);
    store.append(header, payload);
    plans[space].record(transition, *fromWire(header), fieldsOf(header));
    constexpr int group = 16384;
    if (++results % group == 0) store.commit();
  };
  for (const ResultKey& key : asked) solve(key.space, plans[key.space].find(key).value());
  for (bool some = true; some;) {
    some = false;
    for (std::uint32_t space = 0; space < plans.size(); ++space)
      for (const Transition& transition : plans[space].takeReady()) {
        if (results == left) break;
        solve(space, transition);
        some = true;
      }
  }
  store.commit();
  return results;
}

Json make(const Problem& problem, const std::filesystem::path& directory) {
  const auto began = Clock::now();
  const StateDirectory held(directory);
  JobStore store(held, problem);
  std::vector<SpacePlan> plans = store.takeReplay().plans;
  constexpr std::int64_t held_back = 64;
  // The replay requests the first point of each space.
  std::vector<ResultKey> origins;
  for (std::uint32_t space = 0; space < plans.size(); ++space) origins.push_back({space, {}, {}});
  const std::int64_t results = record(problem, store, plans, origins, held_back);
  return {{"results", results},
          {"journal_bytes", store.journalBytes()},
          {"journal_bytes_per_result",
           static_cast<double>(store.journalBytes()) / static_cast<double>(results)},
          {"seconds", secondsSince(began)}};
}

/// Records the results that were held back, so that the dataset can be sealed.
Json complete(const Problem& problem, const std::filesystem::path& directory) {
  const StateDirectory held(directory);
  JobStore store(held, problem);
  Replay replay = store.takeReplay();
  return {{"results", record(problem, store, replay.plans, replay.settled.missing, 0)}};
}

double megabytes(const char* what) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(what)) return std::stod(line.substr(line.find(':') + 1)) / 1024;
  return 0;
}

/// Restarts the measurement of peak memory.
void forgetPeak() { std::ofstream("/proc/self/clear_refs") << "5"; }

/// Reads all bytes of the journal without using them.
Json readPlainly(const std::filesystem::path& directory) {
  const auto began = Clock::now();
  std::vector<char> chunk(std::size_t{1} << 20);
  for (const std::uint32_t segment : JournalReader(directory).segments()) {
    const std::string path = JournalReader(directory).segmentPath(segment).string();
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) throw failure("{}: {}", path, errnoText());
    while (read(file, chunk.data(), chunk.size()) > 0) {
    }
    close(file);
  }
  return {{"seconds", secondsSince(began)}};
}

Json scan(const std::filesystem::path& directory) {
  const auto began = Clock::now();
  std::size_t headers = 0;
  JournalReader(directory).scan(
      [&](const JournalPosition&, std::string_view header) { headers += header.size(); });
  return {{"seconds", secondsSince(began)}, {"peak_mb", megabytes("VmHWM")}};
}

Json openTables(const Problem& problem, const std::filesystem::path& directory) {
  const StateDirectory held(directory);
  const auto began = Clock::now();
  const Tables tables(held, problem);
  return {{"seconds", secondsSince(began)}, {"peak_mb", megabytes("VmHWM")}};
}

Json replayAlone(const Problem& problem, const std::filesystem::path& directory) {
  const auto began = Clock::now();
  const auto found = replayJournal(directory, problem, problemId(problem), {});
  return {{"seconds", secondsSince(began)},
          {"peak_mb", megabytes("VmHWM")},
          {"spare", found.replay.unclaimed.size()}};
}

/// The median of several runs.
double secondsOf(const std::function<void()>& what) {
  std::vector<double> seconds;
  for (int n = 0; n < 5; ++n) {
    const auto began = Clock::now();
    what();
    seconds.push_back(secondsSince(began));
  }
  std::ranges::sort(seconds);
  return seconds[2];
}

/// All steps of a scheduler before it listens, and then the requests of people.
Json restart(const Problem& problem, const std::filesystem::path& directory) {
  const auto began = Clock::now();
  Build build(problem, directory, began);
  const double seconds = secondsSince(began);
  const Coordinator& coordinator = build.coordinator();
  const double peak = megabytes("VmHWM");
  const double status = secondsOf([&] { coordinator.status(Clock::now()); });
  const double forecast = secondsOf([&] { forecastOf(problem, coordinator.plans()); });
  return {{"seconds", seconds},
          {"results", coordinator.found()},
          {"complete", coordinator.complete()},
          {"peak_mb", peak},
          {"peak_bytes_per_result", peak * 1048576 / static_cast<double>(coordinator.found())},
          {"status_seconds", status},
          {"forecast_seconds", forecast}};
}

/// A status and a forecast for plans in which only the first steps are known.
Json lookAhead(const Problem& problem) {
  LinearBody body(problem);
  std::vector<SpacePlan> plans;
  for (std::uint32_t space = 0; space < problem.active.size(); ++space) {
    SpacePlan& plan = plans.emplace_back(problem, space);
    for (int wave = 0; wave < 4; ++wave)
      for (const Transition& transition : plan.takeReady()) {
        const auto [header, payload] = body.solve(plan, space, transition);
        plan.record(transition, *fromWire(header), fieldsOf(header));
      }
  }
  return {{"status_seconds", secondsOf([&] { statusOf(problem, plans); })},
          {"forecast_seconds", secondsOf([&] { forecastOf(problem, plans); })}};
}

Json seal(const Problem& problem, const std::filesystem::path& directory,
          const std::filesystem::path& file) {
  Build build(problem, directory, Clock::now());
  const double before = megabytes("VmRSS");
  forgetPeak();
  const auto began = Clock::now();
  build.seal(file);
  return {{"seconds", secondsSince(began)},
          {"bytes", std::filesystem::file_size(file)},
          {"before_mb", before},
          {"peak_above_before_mb", megabytes("VmHWM") - before}};
}

/// Processor time of this process so far, s, which depends little on other programs.
double processorSeconds() {
  struct rusage usage {};
  if (getrusage(RUSAGE_SELF, &usage) != 0) throw failure("getrusage: {}", errnoText());
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Runs in a separate process with its own peak of memory.
Json inChild(const std::function<Json()>& what) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw failure("pipe: {}", errnoText());
  const pid_t child = fork();
  if (child < 0) throw failure("fork: {}", errnoText());
  if (child == 0) {
    try {
      Json told = what();
      told["processor_seconds"] = processorSeconds();
      const std::string text = told.dump();
      const bool said =
          write(ends[1], text.data(), text.size()) == static_cast<ssize_t>(text.size());
      _exit(said ? 0 : 1);
    } catch (const std::exception& error) {
      fmt::print(stderr, "{}\n", error.what());
      _exit(1);
    }
  }
  close(ends[1]);
  std::string text;
  std::array<char, 4096> chunk{};
  for (ssize_t n = 0; (n = read(ends[0], chunk.data(), chunk.size())) > 0;)
    text.append(chunk.data(), static_cast<std::size_t>(n));
  close(ends[0]);
  int status = 0;
  if (waitpid(child, &status, 0) != child || status != 0)
    throw failure("a part of the benchmark ended with {}", status);
  return Json::parse(text);
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app{"What a build with very many results costs"};
  app.add_option("--results", options.results, "So many, about")->capture_default_str();
  app.add_option("--spaces", options.spaces, "Active nodes")->capture_default_str();
  app.add_option("--directory", options.directory, "A folder on the disk that is measured [/tmp]")
      ->check(CLI::ExistingDirectory);
  app.add_flag("--keep", options.keep, "Use, and leave there, DIRECTORY/large.state");
  app.add_flag("--without-seal", options.without_seal, "Seal nothing");
  CLI11_PARSE(app, argc, argv);
  if (!options.directory.empty()) setenv("TMPDIR", options.directory.c_str(), 1);
  const test::TemporaryDirectory temporary;
  const std::filesystem::path state =
      options.keep ? std::filesystem::path(options.directory) / "large.state" : temporary / "state";
  const Problem problem = problemOf(options);
  Json told = {{"spaces", problem.active.size()},
               {"points_each", uniformLattice(problem.scene).size()},
               {"nodes", problem.mesh.nodes.size()}};
  if (!std::filesystem::exists(state)) told["make"] = inChild([&] { return make(problem, state); });
  told["plain_read"] = inChild([&] { return readPlainly(state); });
  told["scan"] = inChild([&] { return scan(state); });
  told["tables"] = inChild([&] { return openTables(problem, state); });
  told["replay"] = inChild([&] { return replayAlone(problem, state); });
  told["restart"] = inChild([&] { return restart(problem, state); });
  told["begun"] = inChild([&] { return lookAhead(problem); });
  if (options.without_seal) {
    fmt::print("{}\n", told.dump());
    return 0;
  }
  told["complete"] = inChild([&] { return complete(problem, state); });
  told["seal"] = inChild([&] { return seal(problem, state, temporary / "large.h5"); });
  fmt::print("{}\n", told.dump());
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    return palpate::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
