#include <CLI/CLI.hpp>

#include "common/base/child_process.hpp"
#include "common/base/machine.hpp"
#include "scheduler/verbs/served_build.hpp"
#include "scheduler/verbs/verbs.hpp"

// `palpate build`: runs a scheduler with worker processes of its own.

namespace palpate {
namespace {

/// If no worker has connected after this time, give up: the program hangs.
constexpr std::chrono::minutes first_word_limit{2};
/// Time for the workers to end; with --drain 1, they take at most two seconds.
constexpr std::chrono::milliseconds longest_end{3000};

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

/// The workers on this machine: one `palpate-worker work`, which replaces those that die.
class LocalWorkers : public Crew {
 public:
  LocalWorkers(const Server& server, Build& build, int workers)
      : coordinator_(build.coordinator()),
        supervisor_({programBeside("palpate-worker").string(), "work", "-j",
                     std::to_string(workers), "--connect", server.endpoint(), "--keys",
                     build.directory().keys().string(), "--drain", "1", "--quiet"}) {}

  void look() override {
    joined_ = joined_ || coordinator_.workers() > 0;
    if (!joined_ && Clock::now() - started_ > first_word_limit)
      throw failure(
          "no worker has connected within {} min: run palpate-worker kernels to test this machine, "
          "and raise memory limits (ulimit -v)",
          first_word_limit.count());
    if (!supervisor_.running() && !coordinator_.complete() && !coordinator_.stopping())
      throw failure(
          "all workers ended, with {}: see their messages above; the same command continues from "
          "the recorded results",
          supervisor_.how());
  }
  bool isThere() override { return supervisor_.running(); }
  void end() override { supervisor_.terminate(longest_end); }

 private:
  using Clock = std::chrono::steady_clock;

  const Coordinator& coordinator_;
  ChildProcess supervisor_;
  const Clock::time_point started_ = Clock::now();
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
