#include "scheduler/serve_command.hpp"

#include <spdlog/spdlog.h>

#include <filesystem>
#include <memory>

#include "common/base/replaced_file.hpp"
#include "common/problem/problem_warnings.hpp"
#include "common/wire/wire.hpp"
#include "scheduler/build.hpp"
#include "scheduler/build_summary.hpp"
#include "scheduler/progress.hpp"
#include "scheduler/server.hpp"

namespace palpate {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds longest_turn{50};
/// How long workers may take to finish what they hold and leave.
constexpr milliseconds drain_limit{30000};

struct ServeOptions {
  std::string scene;
  std::string endpoint = default_endpoint;
  std::string state;
  std::string out;
  bool insecure = false;
  bool force = false;
};

bool isOnThisMachineOnly(const std::string& endpoint) {
  for (const char* prefix : {"ipc://", "tcp://127.", "tcp://localhost:", "tcp://[::1]:"})
    if (endpoint.starts_with(prefix)) return true;
  return false;
}

void waitForWorkersToLeave(Server& server, Coordinator& coordinator) {
  const auto deadline = Clock::now() + drain_limit;
  while (!coordinator.deserted(Clock::now()) && Clock::now() < deadline)
    server.turn(coordinator, longest_turn);
}

ExitCode finish(const std::vector<SpaceTable>& spaces, const Scene& scene,
                const std::filesystem::path& out, const char* how) {
  fmt::print("{}\n{}: {}\n", summaryOf(spaces, scene), out.string(), how);
  return exitCodeOf(spaces);
}

ExitCode run(const ServeOptions& options) {
  checkEndpoint(options.endpoint);
  if (!isOnThisMachineOnly(options.endpoint) && !options.insecure)
    throw badInput(
        "--listen {}: anyone who reaches that port could take and deliver work, "
        "since there are no keys yet: listen on 127.0.0.1, "
        "or say --insecure on a network you trust",
        options.endpoint);
  Problem problem = loadProblem(options.scene);
  logWarnings(problem);
  const std::filesystem::path out =
      options.out.empty() ? defaultDatasetFile(problem.scene) : std::filesystem::path(options.out);
  if (isSealed(out, problem, options.force))
    return finish(Dataset(out).spaces(), problem.scene, out,
                  "is already the dataset of this scene; nothing to do");

  catchInterrupts();
  Build build(std::move(problem), options.state);
  refuseUnwritable(out, "-o");
  Coordinator& coordinator = build.coordinator();
  if (!coordinator.complete()) {
    zmq::context_t context;
    Server server(context, options.endpoint);
    build.directory().announce(server.endpoint());
    spdlog::info("listening on {}; {} results are recorded already", server.endpoint(),
                 build.found());
    Progress progress;
    while (!coordinator.complete() && !coordinator.stopping()) {
      server.turn(coordinator, longest_turn);
      progress.show(coordinator);
      if (interrupted()) coordinator.stop(Clock::now());
    }
    progress.end();
    waitForWorkersToLeave(server, coordinator);
  }
  if (!coordinator.complete()) {
    fmt::print(stderr,
               "stopped; everything finished is kept in {}. The same command goes on from there.\n",
               options.state);
    return interrupted() ? ExitCode::interrupted : ExitCode::done;
  }
  return finish(build.seal(out), build.problem().scene, out, "sealed");
}

std::function<ExitCode()> prepare(CLI::App& app) {
  auto options = std::make_shared<ServeOptions>();
  app.add_option("SCENE", options->scene, "The scene, a TOML file (docs/scene.md)")
      ->required()
      ->type_name("FILE");
  app.add_option("--listen", options->endpoint, "Where workers connect, tcp://HOST:PORT")
      ->capture_default_str();
  app.add_option("--state", options->state, "Directory for unfinished work, on a local disk")
      ->required();
  app.add_option("-o,--output", options->out,
                 "Dataset to make [the scene's name with .h5, in the current directory]");
  app.add_flag("--insecure", options->insecure,
               "Listen beyond this machine although workers need no key");
  app.add_flag("--force", options->force, "Replace OUTPUT when it holds something else");
  app.footer(
      "Ends when the dataset is sealed, or when it is stopped; the same command then goes on.\n"
      "Exit codes: 0 done or stopped, 1 failed, 2 bad scene or usage, "
      "3 done but some points failed, 130 interrupted.");
  return [options] { return run(*options); };
}

}  // namespace

const Verb serve_verb = {
    "serve", "Compute the dataset of a scene with workers that connect from anywhere", prepare};

}  // namespace palpate
