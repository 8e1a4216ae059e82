#include "scheduler/builds/asked_scheduler.hpp"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <limits>

#include "common/base/text.hpp"
#include "common/wire/curve.hpp"
#include "scheduler/builds/recorded_build.hpp"
#include "scheduler/service/status.hpp"

namespace palpate {
namespace {

/// Returns the build id in the tables of a directory; none, with a warning, if that fails.
std::optional<ContentId> buildIn(const std::filesystem::path& directory) {
  try {
    return StoredTables(directory).build().build;
  } catch (const Error& error) {
    spdlog::warn("{}", error.what());
    return std::nullopt;
  }
}

/// Sends one question and waits for the answer.
wire::Message ask(const StateDirectory::Address& scheduler, const wire::Message& question) {
  const std::string& endpoint = scheduler.endpoint;
  constexpr std::chrono::duration<double> patience{5};
  zmq::context_t context;
  zmq::socket_t socket = makeDealer(context);
  // Queue the question until the connection is established.
  socket.set(zmq::sockopt::immediate, false);
  if (scheduler.keys) proveAsClient(socket, *scheduler.keys, endpoint);
  HandshakeWatch handshakes(context, socket);
  if (const std::string trouble = connectDealer(socket, endpoint); !trouble.empty())
    throw failure("{}: {}", endpoint, trouble);
  if (sendMessage(socket, "", question) != Sent::yes) throw failure("{}: sending failed", endpoint);
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < deadline) {
    if (auto answer = receiveMessage(socket, false)) {
      if (answer->message.has_refused())
        throw failure("{}: refused: {}", endpoint,
                      printable(answer->message.refused().reason(), longest_reason));
      return std::move(answer->message);
    }
    if (const std::string trouble = handshakes.trouble(); !trouble.empty())
      throw failure("{}: {}", endpoint, trouble);
    if (!waitForMessages(socket, std::chrono::milliseconds(100)))
      throw Error(ExitCode::interrupted, "interrupted");
  }
  throw failure("{}: no answer within {:.1f} s: is a Palpate scheduler running there?", endpoint,
                patience.count());
}

/// Asks for the status. Throws Error if `where` is a state directory and the scheduler belongs to
/// another build.
wire::Status askStatus(const StateDirectory::Address& scheduler, const std::string& where) {
  const std::string& endpoint = scheduler.endpoint;
  wire::Message question;
  question.mutable_status_request();
  const wire::Message answer = ask(scheduler, question);
  if (!answer.has_status_reply())
    throw failure("{}: the program that answers there is not a Palpate scheduler", endpoint);
  wire::Status status = statusFromJson(answer.status_reply().json(), endpoint);
  if (endpoint == where) return status;
  if (const auto build = buildIn(where); build && build->hex() != status.build())
    throw failure(
        "{}: a scheduler of another build (scene \"{}\", build {}) answers at {}, in place of the "
        "scheduler of this directory (build {}, process {}): end the wrong scheduler, and start "
        "that of this directory again, at an endpoint of its own",
        where, status.scene(), status.build().substr(0, 12), endpoint, build->shortHex(),
        StateDirectory::holder(where).value_or("ended"));
  return status;
}

/// Builds the status from a state directory in which no scheduler runs.
wire::Status storedStatus(const std::filesystem::path& directory) {
  wire::Status status = progressIn(directory);
  StoredTables tables(directory);
  std::vector<wire::WorkerStatus> servers = tables.servers();
  // The tables hold each worker's last known state. No scheduler runs now, so every worker that
  // was not lost is shown as left.
  for (wire::WorkerStatus& row : servers)
    if (row.state() != "lost") row.set_state("left");
  addServers(status, servers, tables.counters());
  addKeptOut(status, tables.keptOut());
  addDisk(status, directory,
          JournalReader(directory).bytesBefore(std::numeric_limits<std::uint32_t>::max()));
  status.set_paused(tables.paused());
  setPriorities(status, tables.priorities());
  const std::map<ResultKey, bool> checks = tables.checks();
  status.set_checks_open(static_cast<std::int32_t>(checks.size()));
  status.set_disputed(static_cast<std::int32_t>(
      std::ranges::count_if(checks, [](const auto& check) { return check.second; })));
  return status;
}

}  // namespace

void Asked::addTo(CLI::App& app) {
  app.add_option("WHERE", where, "Scheduler (tcp://HOST:PORT) or state directory")
      ->capture_default_str();
  keys.addTo(app, "Connect without a key, to a scheduler that requires none");
}

NotListening::NotListening(const std::string& directory, const std::string& process)
    : Error(ExitCode::failed,
            fmt::format("{}: process {} is starting there; it is still reading the recorded "
                        "results and cannot answer yet; ask again later",
                        directory, process)) {}

std::optional<StateDirectory::Address> schedulerOf(const Asked& asked) {
  const std::string& where = asked.where;
  if (where.starts_with("tcp://") || where.starts_with("ipc://"))
    return StateDirectory::Address{where, asked.keys.keys()};
  if (std::error_code none; !std::filesystem::is_directory(where, none))
    throw badInput("\"{}\" is neither tcp://HOST:PORT nor a state directory", where);
  const auto process = StateDirectory::holder(where);
  if (!process) return std::nullopt;
  if (auto address = StateDirectory::liveAddress(where)) return address;
  throw NotListening(where, *process);
}

wire::Status statusAt(const Asked& asked) {
  if (const auto scheduler = schedulerOf(asked)) {
    try {
      return askStatus(*scheduler, asked.where);
    } catch (const Error&) {
      // If the scheduler has ended meanwhile, go on and read its directory.
      if (schedulerOf(asked)) throw;
    }
  }
  return storedStatus(asked.where);
}

std::optional<wire::Message> order(const Asked& asked, const wire::Message& what,
                                   wire::Message::BodyCase answer) {
  const auto scheduler = schedulerOf(asked);
  if (!scheduler) return std::nullopt;
  if (scheduler->endpoint != asked.where) askStatus(*scheduler, asked.where);
  wire::Message said = ask(*scheduler, what);
  if (said.body_case() == answer) return said;
  throw failure("{}: the program that answers there is not a Palpate scheduler of this version",
                scheduler->endpoint);
}

}  // namespace palpate
