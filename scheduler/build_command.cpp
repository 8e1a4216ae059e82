#include "scheduler/build_command.hpp"

#include <spdlog/spdlog.h>

#include <filesystem>
#include <memory>
#include <thread>

#include "common/base/replaced_file.hpp"
#include "common/problem/problem_warnings.hpp"
#include "scheduler/build.hpp"
#include "scheduler/build_summary.hpp"
#include "scheduler/progress.hpp"
#include "scheduler/server.hpp"
#include "scheduler/status.hpp"
#include "scheduler/worker_pool.hpp"

namespace palpate {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

/// So many workers may end in a row without one new result. A target that kills its workers is
/// given up after fewer.
constexpr int deaths_without_progress = 20;
/// So many when none of them ever said hello: then it is not the work, it is the program.
constexpr int deaths_at_the_start = 3;
/// How long workers may take to finish what they hold.
constexpr milliseconds drain_limit{15000};
constexpr milliseconds longest_turn{50};

struct BuildOptions {
  std::string scene;
  std::string out;
  std::string state;
  int workers = 0;
  bool force = false;
};

/// Replaces workers that end before the work does, within bounds.
class Replacement {
 public:
  void replace(WorkerPool& pool, Coordinator& coordinator) {
    if (coordinator.recorded() > recorded_) deaths_ = 0;
    recorded_ = coordinator.recorded();
    joined_ = joined_ || coordinator.workers() > 0;
    for (const WorkerPool::Ended& ended : pool.reap()) {
      if (coordinator.complete() || coordinator.stopping()) continue;
      coordinator.workerProcessEnded(static_cast<std::uint32_t>(ended.pid), Clock::now());
      if (++deaths_ >= (joined_ ? deaths_without_progress : deaths_at_the_start))
        throw failure(
            "{} workers in a row ended before they finished anything, the last with {}: "
            "see their messages above; the same command goes on from what is recorded",
            deaths_, ended.how);
      spdlog::warn("worker {} ended with {}: starting another", ended.pid, ended.how);
      pool.start();
    }
  }

 private:
  std::int64_t recorded_ = 0;
  int deaths_ = 0;
  bool joined_ = false;
};

void waitForWorkersToLeave(Server& server, Coordinator& coordinator, WorkerPool& pool) {
  for (const auto deadline = Clock::now() + drain_limit;
       pool.running() > 0 && Clock::now() < deadline; pool.reap())
    server.turn(coordinator, longest_turn);
  pool.terminate(milliseconds(2000));
}

/// True when complete, false when it was stopped.
bool compute(Build& build, int workers) {
  Coordinator& coordinator = build.coordinator();
  if (coordinator.complete()) return true;
  zmq::context_t context;
  Server server(context, "tcp://127.0.0.1:*");
  build.directory().announce(server.endpoint());
  WorkerPool pool({programBeside("palpate-worker").string(), "work", "--connect", server.endpoint(),
                   "-j", "1", "--quiet"});
  for (int n = 0; n < workers; ++n) pool.start();

  Progress progress;
  Replacement replacement;
  while (!coordinator.complete() && !coordinator.stopping()) {
    server.turn(coordinator, longest_turn);
    replacement.replace(pool, coordinator);
    progress.show(coordinator);
    if (interrupted()) coordinator.stop(Clock::now());
  }
  waitForWorkersToLeave(server, coordinator, pool);
  progress.end();
  return coordinator.complete();
}

ExitCode finish(const std::vector<SpaceTable>& spaces, const Scene& scene,
                const std::filesystem::path& out, const std::string& how) {
  fmt::print("{}\n{}: {}\nnext: palpate query '{}' --active {} --displacement {:.3g} 0 0\n",
             summaryOf(spaces, scene), out.string(), how, out.string(), spaces.front().patch.name,
             scene.workspace.spacing / 2);
  return exitCodeOf(spaces);
}

ExitCode run(const BuildOptions& options) {
  Problem problem = loadProblem(options.scene);
  logWarnings(problem);
  const std::filesystem::path out =
      options.out.empty() ? defaultDatasetFile(problem.scene) : std::filesystem::path(options.out);
  const std::filesystem::path state =
      options.state.empty() ? out.string() + ".state" : options.state;
  if (isSealed(out, problem, options.force))
    return finish(Dataset(out).spaces(), problem.scene, out,
                  "is already the dataset of this scene; nothing to do");

  catchInterrupts();
  const auto began = Clock::now();
  Build build(std::move(problem), state);
  refuseUnwritable(out, "-o");
  if (build.found() > 0 && !build.coordinator().complete())
    spdlog::info("going on: {} results are recorded in {}", build.found(), state.string());
  const int workers = options.workers > 0
                          ? options.workers
                          : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  if (!compute(build, workers)) {
    fmt::print(stderr,
               "stopped; everything finished is kept in {}. The same command goes on from there.\n",
               state.string());
    return ExitCode::interrupted;
  }
  const std::vector<SpaceTable> spaces = build.seal(out);
  const double seconds = std::chrono::duration<double>(Clock::now() - began).count();
  return finish(spaces, build.problem().scene, out,
                fmt::format("sealed after {:.1f} s with {} worker{}", seconds, workers,
                            workers == 1 ? "" : "s"));
}

std::function<ExitCode()> prepare(CLI::App& app) {
  auto options = std::make_shared<BuildOptions>();
  app.add_option("SCENE", options->scene, "The scene, a TOML file (docs/scene.md)")
      ->required()
      ->type_name("FILE");
  app.add_option("-o,--output", options->out,
                 "Dataset to make [the scene's name with .h5, in the current directory]");
  app.add_option("-j,--workers", options->workers,
                 "Worker processes, one core each [number of cores]")
      ->check(CLI::Range(1, 4096));
  app.add_option("--state", options->state,
                 "Directory for unfinished work, on a local disk [OUTPUT.state]");
  app.add_flag("--force", options->force, "Replace OUTPUT when it holds something else");
  app.footer(
      "Interrupt it whenever you like: the same command goes on where it was.\n"
      "Exit codes: 0 done, 1 failed, 2 bad scene or usage, 3 done but some points failed, "
      "130 interrupted.");
  return [options] { return run(*options); };
}

}  // namespace

const Verb build_verb = {"build", "Compute the dataset of a scene with workers on this machine",
                         prepare};

}  // namespace palpate
