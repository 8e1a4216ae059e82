#include <CLI/CLI.hpp>
#include <memory>

#include "common/wire/wire.hpp"
#include "scheduler/request.hpp"
#include "scheduler/verbs.hpp"

namespace palpate {
namespace {

ExitCode stop(const std::string& where) {
  const std::string endpoint = endpointOf(where);
  if (endpoint.empty()) throw failure("{}: no scheduler is working there now", where);
  wire::Message question;
  question.mutable_stop_request();
  if (!ask(endpoint, question).stop_reply().stopping())
    throw failure("{}: the scheduler did not agree to stop", endpoint);
  fmt::print("{}: stopping; the same command goes on from what is recorded\n", endpoint);
  return ExitCode::done;
}

std::function<ExitCode()> prepareStop(CLI::App& app) {
  auto where = std::make_shared<std::string>(default_endpoint);
  app.add_option("WHERE", *where, "Scheduler, tcp://HOST:PORT, or its state directory")
      ->capture_default_str();
  return [where] { return stop(*where); };
}

}  // namespace

const Verb stop_verb = {
    "stop", "Let a scheduler's workers finish what they hold and end it; it can go on later",
    prepareStop};

}  // namespace palpate
