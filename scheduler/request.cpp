#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <thread>

#include "common/base/error.hpp"
#include "common/problem/problem.hpp"
#include "common/wire/wire.hpp"
#include "scheduler/service/status.hpp"
#include "scheduler/state/replay.hpp"
#include "scheduler/status_text.hpp"
#include "scheduler/verbs.hpp"

// What a running scheduler is asked: `status`, `stop` and `retry`.

namespace palpate {
namespace {

constexpr std::chrono::seconds watch_every{1};

/// Asks a scheduler one thing and waits for the answer. Error when none comes within 5 s, or the
/// endpoint makes no sense.
wire::Message ask(const std::string& endpoint, const wire::Message& question) {
  constexpr std::chrono::duration<double> patience{5};
  zmq::context_t context;
  zmq::socket_t socket = makeDealer(context);
  // The question waits until there is a connection.
  socket.set(zmq::sockopt::immediate, false);
  connectDealer(socket, endpoint);
  if (sendMessage(socket, "", question) != Sent::yes) throw failure("{}: cannot send", endpoint);
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < deadline) {
    if (auto answer = receiveMessage(socket, false)) return std::move(answer->message);
    if (!waitForMessages(socket, std::chrono::milliseconds(100)))
      throw Error(ExitCode::interrupted, "interrupted");
  }
  throw failure("{}: no answer within {:.1f} s: is a Palpate scheduler running there?", endpoint,
                patience.count());
}

/// The endpoint that `where` means: itself when it is tcp:// or ipc://, else that of the scheduler
/// which now works in the state directory `where`; empty when none does. Error (bad input) when it
/// is neither.
std::string endpointOf(const std::string& where) {
  if (where.starts_with("tcp://") || where.starts_with("ipc://")) return where;
  if (!std::filesystem::is_directory(where))
    throw badInput("\"{}\" is neither tcp://HOST:PORT nor a state directory", where);
  return StateDirectory::liveEndpoint(where).value_or("");
}

/// What the tables of a directory are about; nothing when they cannot be read.
std::optional<ContentId> buildIn(const std::filesystem::path& directory) {
  try {
    return StoredTables(directory).build().build;
  } catch (const Error& error) {
    spdlog::warn("{}", error.what());
    return std::nullopt;
  }
}

/// The status of the scheduler that answers at `endpoint`. Error when `where` is a state directory
/// and that scheduler is one of another build: somebody took the endpoint over.
wire::Status askStatus(const std::string& endpoint, const std::string& where) {
  wire::Message question;
  question.mutable_status_request();
  const wire::Message answer = ask(endpoint, question);
  if (!answer.has_status_reply())
    throw failure("{}: what answers there is not a Palpate scheduler", endpoint);
  wire::Status status = statusFromJson(answer.status_reply().json());
  if (endpoint == where) return status;
  if (const auto build = buildIn(where); build && build->hex() != status.build())
    throw failure(
        "{}: a scheduler of another build (scene \"{}\", build {}) answers at {}, "
        "where the one that works in this directory (build {}, process {}) should: "
        "end the wrong one, and start this one again at an endpoint of its own",
        where, status.scene(), status.build().substr(0, 12), endpoint, build->shortHex(),
        StateDirectory::holder(where).value_or("ended"));
  return status;
}

struct StatusOptions {
  std::string where = default_endpoint;
  bool watch = false;
  bool json = false;
};

/// From the tables of a directory in which nobody works.
wire::Status storedStatus(const std::filesystem::path& directory) {
  StoredTables tables(directory);
  const Problem problem = decodeProblem(tables.build().problem);
  const RecordedResults recorded = readResults(directory, tables.build().build);
  for (const std::string& damage : recorded.damage)
    spdlog::warn("{}; what was recorded there will be computed again", damage);
  const Replay replayed = replay(problem, recorded.results);
  std::vector<wire::WorkerStatus> servers = tables.servers();
  // What the tables last said; no scheduler runs that they could be idle or busy for.
  for (wire::WorkerStatus& row : servers)
    if (row.state() != "lost") row.set_state("left");
  wire::Status status = statusOf(problem, replayed.plans, servers, tables.counters());
  status.set_build(tables.build().build.hex());
  const bool complete = std::ranges::all_of(replayed.plans, &SpacePlan::complete);
  status.set_state(complete ? "complete" : "stopped");
  return status;
}

wire::Status statusOfBuild(const std::string& where) {
  const std::string endpoint = endpointOf(where);
  return endpoint.empty() ? storedStatus(where) : askStatus(endpoint, where);
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

ExitCode stop(const std::string& where) {
  const std::string endpoint = endpointOf(where);
  if (endpoint.empty()) throw failure("{}: no scheduler is working there now", where);
  if (endpoint != where) askStatus(endpoint, where);
  wire::Message question;
  question.mutable_stop_request();
  if (!ask(endpoint, question).stop_reply().stopping())
    throw failure("{}: the scheduler did not agree to stop", endpoint);
  fmt::print("{}: stopping; the same command goes on from what is recorded\n", endpoint);
  return ExitCode::done;
}

// ---- retry ----

/// Of a directory in which nobody works.
std::int64_t retryStored(const std::filesystem::path& directory) {
  // What is no state directory is refused before one is made of it.
  const StoredTables there{directory};
  return forgetLosses(StateDirectory(directory));
}

ExitCode retry(const std::string& where) {
  const std::string endpoint = endpointOf(where);
  std::int64_t transitions = 0;
  if (endpoint.empty()) {
    transitions = retryStored(where);
  } else {
    if (endpoint != where) askStatus(endpoint, where);
    wire::Message question;
    question.mutable_retry_request();
    const wire::Message answer = ask(endpoint, question);
    if (!answer.has_retry_reply())
      throw failure("{}: what answers there is not a Palpate scheduler", endpoint);
    transitions = answer.retry_reply().transitions();
  }
  fmt::print("{}: {} transition(s) that were set aside {}\n", where, transitions,
             endpoint.empty() ? "will be tried again by the next build" : "are tried again");
  return ExitCode::done;
}

std::function<ExitCode()> prepareRetry(CLI::App& app) {
  auto where = std::make_shared<std::string>(default_endpoint);
  app.add_option("WHERE", *where, "Scheduler, tcp://HOST:PORT, or a state directory")
      ->capture_default_str();
  app.footer(
      "A transition is set aside after five workers ended while they solved it; the rest of the\n"
      "build goes on without it.");
  return [where] { return retry(*where); };
}

std::function<ExitCode()> prepareStop(CLI::App& app) {
  auto where = std::make_shared<std::string>(default_endpoint);
  app.add_option("WHERE", *where, "Scheduler, tcp://HOST:PORT, or its state directory")
      ->capture_default_str();
  return [where] { return stop(*where); };
}

}  // namespace

const Verb retry_verb = {"retry", "Try again what was set aside because workers ended on it",
                         prepareRetry};

const Verb status_verb = {
    "status", "How far a build is: points, rate, time left, workers, failures", prepareStatus};

const Verb stop_verb = {
    "stop", "Let a scheduler's workers finish what they hold and end it; it can go on later",
    prepareStop};

}  // namespace palpate
