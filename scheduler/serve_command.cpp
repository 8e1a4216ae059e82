#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "common/wire/wire.hpp"
#include "scheduler/build.hpp"
#include "scheduler/verbs.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

struct ServeOptions {
  BuildOrder order;
  std::string endpoint = default_endpoint;
  bool insecure = false;
};

ExitCode serve(Server& server, Coordinator& coordinator) {
  // How long workers may take to finish what they hold and leave.
  constexpr std::chrono::seconds drain_limit{30};
  spdlog::info("listening on {}", server.endpoint());
  serveUntilDone(server, coordinator);
  for (const auto deadline = Clock::now() + drain_limit;
       !coordinator.deserted(Clock::now()) && Clock::now() < deadline;)
    server.turn(coordinator, longest_turn);
  return interrupted() ? ExitCode::interrupted : ExitCode::done;
}

ExitCode run(const ServeOptions& options) {
  checkEndpoint(options.endpoint);
  if (!isOnThisMachineOnly(options.endpoint) && !options.insecure)
    throw badInput(
        "--listen {}: anyone who reaches that port could take and deliver work, "
        "since there are no keys yet: listen on 127.0.0.1, "
        "or say --insecure on a network you trust",
        options.endpoint);
  return carryOut(options.order, options.endpoint, serve);
}

std::function<ExitCode()> prepareServe(CLI::App& app) {
  auto options = std::make_shared<ServeOptions>();
  addOptions(app, options->order);
  app.get_option("--state")->required()->description(
      "Directory for unfinished work, on a local disk");
  app.add_option("--listen", options->endpoint, "Where workers connect, tcp://HOST:PORT")
      ->capture_default_str();
  app.add_flag("--insecure", options->insecure,
               "Listen beyond this machine although workers need no key");
  app.footer(
      "Ends when the dataset is sealed, or when it is stopped; the same command then goes on.\n"
      "Exit codes: 0 done or stopped, 1 failed, 2 bad scene or usage, "
      "3 done but some points failed, 130 interrupted.");
  return [options] { return run(*options); };
}

}  // namespace

const Verb serve_verb = {"serve",
                         "Compute the dataset of a scene with workers that connect from anywhere",
                         prepareServe};

}  // namespace palpate
