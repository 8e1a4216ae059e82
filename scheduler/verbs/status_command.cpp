#include <unistd.h>

#include <CLI/CLI.hpp>
#include <thread>

#include "common/base/terminal.hpp"
#include "scheduler/builds/asked_scheduler.hpp"
#include "scheduler/service/status.hpp"
#include "scheduler/verbs/status_text.hpp"
#include "scheduler/verbs/verbs.hpp"

namespace palpate {
namespace {

constexpr std::chrono::seconds watch_every{1};

struct StatusOptions {
  Asked asked;
  bool watch = false;
  bool json = false;

  void addTo(CLI::App& app) {
    asked.addTo(app);
    app.add_flag("--watch", watch, "Repeat every second until the build is complete or stops");
    app.add_flag("--json", json, "Print one JSON object per line (docs/commands.md)");
  }
};

/// Returns the status, and the page of text that shows it.
std::pair<wire::Status, std::string> lookAt(const Asked& asked) {
  wire::Status status;
  try {
    status = statusAt(asked);
    return {status, describe(status)};
  } catch (const NotListening& starting) {
    status.set_state("starting");
    return {status, std::string(starting.what()) + '\n'};
  }
}

ExitCode showStatus(const StatusOptions& options) {
  catchInterrupts();
  const bool redraw = options.watch && !options.json && isatty(STDOUT_FILENO) == 1;
  for (;;) {
    const auto [status, page] = lookAt(options.asked);
    if (options.json)
      fmt::print("{}\n", toJson(status));
    else if (redraw)
      fmt::print("\x1b[H\x1b[2J{}", fitted(page, sizeOf(STDOUT_FILENO)));
    else
      fmt::print("{}", page);
    std::fflush(stdout);
    if (!options.watch || status.state() == "complete" || status.state() == "stopped")
      return ExitCode::done;
    std::this_thread::sleep_for(watch_every);
    if (interrupted()) return ExitCode::interrupted;
  }
}

}  // namespace

const Verb status_verb = {
    "status", "Show the progress of a build: points, rate, time left, workers, failures by cause",
    prepareVerb<StatusOptions, showStatus>};

}  // namespace palpate
