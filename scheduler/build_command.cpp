#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <thread>

#include "scheduler/build.hpp"
#include "scheduler/verbs.hpp"
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

struct BuildOptions {
  BuildOrder order;
  int workers = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
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

ExitCode compute(Server& server, Coordinator& coordinator, int workers) {
  // How long workers may take to finish what they hold.
  constexpr milliseconds drain_limit{15000};
  WorkerPool pool({programBeside("palpate-worker").string(), "work", "--connect", server.endpoint(),
                   "-j", "1", "--quiet"});
  for (int n = 0; n < workers; ++n) pool.start();

  Replacement replacement;
  serveUntilDone(server, coordinator, [&] { replacement.replace(pool, coordinator); });
  for (const auto deadline = Clock::now() + drain_limit;
       pool.running() > 0 && Clock::now() < deadline; pool.reap())
    server.turn(coordinator, longest_turn);
  pool.terminate(milliseconds(2000));
  return ExitCode::interrupted;
}

std::function<ExitCode()> prepareBuild(CLI::App& app) {
  auto options = std::make_shared<BuildOptions>();
  addOptions(app, options->order);
  app.add_option("-j,--workers", options->workers,
                 "Worker processes, one core each [number of cores]")
      ->check(CLI::Range(1, 4096));
  app.footer(
      "Interrupt it whenever you like: the same command goes on where it was.\n"
      "Exit codes: 0 done, 1 failed, 2 bad scene or usage, 3 done but some points failed, "
      "130 interrupted.");
  return [options] {
    return carryOut(options->order, "tcp://127.0.0.1:*", [&](Server& server, Coordinator& build) {
      return compute(server, build, options->workers);
    });
  };
}

}  // namespace

const Verb build_verb = {"build", "Compute the dataset of a scene with workers on this machine",
                         prepareBuild};

}  // namespace palpate
