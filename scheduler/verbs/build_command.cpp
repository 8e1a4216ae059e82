#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "common/base/assertion.hpp"
#include "common/base/machine.hpp"
#include "scheduler/fleet/worker_pool.hpp"
#include "scheduler/verbs/served_build.hpp"
#include "scheduler/verbs/verbs.hpp"

// `palpate build`: runs a scheduler with worker processes of its own.

namespace palpate {
namespace {

using std::chrono::milliseconds;

/// Give up if this many workers in a row end without a new result. A target that kills its workers
/// is set aside earlier.
constexpr int deaths_without_progress = 20;
/// The lower limit while no worker has ever connected: the program itself probably fails.
constexpr int deaths_at_the_start = 3;
/// If no worker has connected after this time, give up: the program hangs.
constexpr std::chrono::minutes first_word_limit{2};

struct BuildOptions {
  BuildOrder order;
  int workers = static_cast<int>(coreCount());

  void addTo(CLI::App& app) {
    order.addTo(app);
    app.add_option("-j,--workers", workers, "Worker processes, one core each [number of cores]")
        ->check(CLI::Range(1, 4096));
    app.footer(
        "You can interrupt a build at any time; the same command continues it.\n"
        "Exit codes: 0 done, 1 failed, 2 bad scene or usage, 3 done but some points failed, 130 "
        "interrupted.");
  }
};

/// Worker processes on this machine. A process that ends is replaced.
class LocalWorkers : public Crew {
 public:
  LocalWorkers(const Server& server, Build& build, int workers)
      : coordinator_(build.coordinator()),
        workers_(static_cast<std::size_t>(workers)),
        pool_({programBeside("palpate-worker").string(), "work", "--connect", server.endpoint(),
               "--keys", build.directory().keys().string(), "--alone", "--quiet"}) {
    while (pool_.running() < workers_) pool_.start();
  }

  void look() override {
    if (coordinator_.recorded() > recorded_) deaths_ = 0;
    recorded_ = coordinator_.recorded();
    joined_ = joined_ || coordinator_.workers() > 0;
    if (!joined_ && Clock::now() - started_ > first_word_limit)
      throw failure(
          "no worker has connected within {} min: run palpate-worker kernels to test this machine, "
          "and raise memory limits (ulimit -v)",
          first_word_limit.count());
    for (const WorkerPool::Ended& ended : pool_.reap())
      if (!coordinator_.complete() && !coordinator_.stopping()) replace(ended);
  }
  bool isThere() override {
    pool_.reap();
    return pool_.running() > 0;
  }
  void end() override { pool_.terminate(milliseconds(2000)); }

 private:
  using Clock = std::chrono::steady_clock;

  void replace(const WorkerPool::Ended& ended) {
    coordinator_.workerProcessEnded(static_cast<std::uint32_t>(ended.pid), Clock::now());
    if (++deaths_ >= (joined_ ? deaths_without_progress : deaths_at_the_start))
      throw failure(
          "{} workers in a row ended without a result, the last with {}: see their messages above; "
          "the same command continues from the recorded results",
          deaths_, ended.how);
    spdlog::warn("worker {} ended with {}: starting another", ended.pid, ended.how);
    PALPATE_ASSERT(pool_.running() < workers_, "a worker must replace one that ended");
    pool_.start();
  }

  Coordinator& coordinator_;
  const std::size_t workers_;
  WorkerPool pool_;
  const Clock::time_point started_ = Clock::now();
  std::int64_t recorded_ = 0;
  int deaths_ = 0;  ///< number of workers that ended in a row without a new result
  bool joined_ = false;
};

ExitCode buildHere(const BuildOptions& options) {
  requireMemory(memory_of_a_solver);  // for a worker
  const auto crew = [&](Server& server, Build& build) {
    return std::make_unique<LocalWorkers>(server, build, options.workers);
  };
  return serveBuild(options.order, {.endpoint = "tcp://127.0.0.1:*",
                                    .own_keys = true,
                                    .crew = crew,
                                    .drain_limit = std::chrono::seconds(15)});
}

}  // namespace

const Verb build_verb = {"build", "Compute the dataset of a scene with workers on this machine",
                         prepareVerb<BuildOptions, buildHere>};

}  // namespace palpate
