#include "scheduler/build_order.hpp"

#include <spdlog/spdlog.h>

#include <filesystem>

#include "common/base/replaced_file.hpp"
#include "common/problem/problem_warnings.hpp"
#include "scheduler/build_summary.hpp"
#include "scheduler/progress.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

ExitCode finish(const std::vector<SpaceTable>& spaces, const Scene& scene,
                const std::filesystem::path& out, const std::string& how) {
  fmt::print("{}\n{}: {}\nnext: palpate query '{}' --active {} --displacement {:.3g} 0 0\n",
             summaryOf(spaces, scene), out.string(), how, out.string(), spaces.front().patch.name,
             scene.workspace.spacing / 2);
  return exitCodeOf(spaces);
}

}  // namespace

void addOptions(CLI::App& app, BuildOrder& order) {
  app.add_option("SCENE", order.scene, "The scene, a TOML file (docs/scene.md)")
      ->required()
      ->type_name("FILE");
  app.add_option("-o,--output", order.out,
                 "Dataset to make [the scene's name with .h5, in the current directory]");
  app.add_option("--state", order.state,
                 "Directory for unfinished work, on a local disk [OUTPUT.state]");
  app.add_flag("--force", order.force, "Replace OUTPUT when it holds something else");
}

ExitCode carryOut(const BuildOrder& order, const std::function<ExitCode(Build&)>& compute) {
  Problem problem = loadProblem(order.scene);
  logWarnings(problem);
  const std::filesystem::path out = order.out.empty() ? problem.scene.name + ".h5" : order.out;
  const std::string state = order.state.empty() ? out.string() + ".state" : order.state;
  if (isSealed(out, problem, order.force))
    return finish(Dataset(out).spaces(), problem.scene, out,
                  "is already the dataset of this scene; nothing to do");
  // Before the state directory is made, and before hours of work.
  refuseUnwritable(out, "-o");

  catchInterrupts();
  const auto began = Clock::now();
  Build build(std::move(problem), state);
  if (!build.coordinator().complete()) {
    if (build.found() > 0)
      spdlog::info("going on: {} results are recorded in {}", build.found(), state);
    const ExitCode when_stopped = compute(build);
    if (!build.coordinator().complete()) {
      fmt::print(stderr,
                 "stopped; everything finished is kept in {}. "
                 "The same command goes on from there.\n",
                 state);
      return when_stopped;
    }
  }
  const std::vector<SpaceTable> spaces = build.seal(out);
  const double seconds = std::chrono::duration<double>(Clock::now() - began).count();
  return finish(spaces, build.problem().scene, out, fmt::format("sealed after {:.1f} s", seconds));
}

void serveUntilDone(Server& server, Coordinator& coordinator,
                    const std::function<void()>& each_turn) {
  Progress progress;
  while (!coordinator.complete() && !coordinator.stopping()) {
    server.turn(coordinator, longest_turn);
    if (each_turn) each_turn();
    progress.show(coordinator);
    if (interrupted()) coordinator.stop(Clock::now());
  }
  progress.end();
}

}  // namespace palpate
