#include <CLI/CLI.hpp>
#include <memory>
#include <thread>

#include "common/problem/problem.hpp"
#include "common/wire/wire.hpp"
#include "scheduler/request.hpp"
#include "scheduler/service/status.hpp"
#include "scheduler/state/replay.hpp"
#include "scheduler/status_text.hpp"
#include "scheduler/verbs.hpp"

namespace palpate {
namespace {

constexpr std::chrono::seconds watch_every{1};

struct StatusOptions {
  std::string where = default_endpoint;
  bool watch = false;
  bool json = false;
};

/// From the tables of a directory in which nobody works.
wire::Status storedStatus(const std::filesystem::path& directory) {
  StoredTables tables(directory);
  const Problem problem = decodeProblem(tables.build().problem);
  const Replay replayed = replay(problem, tables.results());
  std::vector<wire::WorkerStatus> servers = tables.servers();
  // What the tables last said; no scheduler runs that they could be idle or busy for.
  for (wire::WorkerStatus& row : servers)
    if (row.state() != "lost") row.set_state("left");
  wire::Status status = statusOf(problem, replayed.plans, servers, tables.counters());
  status.set_build(tables.build().build.hex());
  status.set_state(tables.build().complete ? "complete" : "stopped");
  return status;
}

wire::Status statusOfBuild(const std::string& where) {
  const std::string endpoint = endpointOf(where);
  if (endpoint.empty()) return storedStatus(where);
  wire::Message question;
  question.mutable_status_request();
  const wire::Message answer = ask(endpoint, question);
  if (!answer.has_status_reply())
    throw failure("{}: what answers there is not a Palpate scheduler", endpoint);
  return statusFromJson(answer.status_reply().json());
}

ExitCode showStatus(const StatusOptions& options) {
  catchInterrupts();
  const bool redraw = options.watch && !options.json && isatty(STDOUT_FILENO) == 1;
  for (;;) {
    const wire::Status status = statusOfBuild(options.where);
    fmt::print("{}{}", redraw ? "\x1b[H\x1b[2J" : "",
               options.json ? toJson(status) + '\n' : describe(status));
    std::fflush(stdout);
    if (!options.watch || status.state() == "complete" || status.state() == "stopped")
      return ExitCode::done;
    std::this_thread::sleep_for(watch_every);
    if (interrupted()) return ExitCode::interrupted;
  }
}

std::function<ExitCode()> prepareStatus(CLI::App& app) {
  auto options = std::make_shared<StatusOptions>();
  app.add_option("WHERE", options->where, "Scheduler, tcp://HOST:PORT, or a state directory")
      ->capture_default_str();
  app.add_flag("--watch", options->watch,
               "Again every second, until the build is complete or stops");
  app.add_flag("--json", options->json, "One JSON object per line (docs/commands.md)");
  return [options] { return showStatus(*options); };
}

}  // namespace

const Verb status_verb = {
    "status", "How far a build is: points, rate, time left, workers, failures", prepareStatus};

}  // namespace palpate
