
#include "common/base/required_option.hpp"
#include "scheduler/verbs/inspection_text.hpp"
#include "scheduler/verbs/verbs.hpp"

namespace palpate {
namespace {

struct CheckStateOptions {
  std::string directory;
  bool repair = false;
  bool json = false;

  void addTo(CLI::App& app) {
    addRequired(app, "DIRECTORY", directory, "State directory (docs/internals/state.md)");
    app.add_flag("--repair", repair,
                 "Drop damaged records and rebuild damaged tables; no scheduler may run");
    app.add_flag("--json", json, "Print one JSON object (docs/commands.md)");
    app.footer(
        "Changes nothing without --repair. For a scene (a TOML file), `palpate check` prints a "
        "summary.\n"
        "Exit codes: 0 whole, 1 damaged, 2 not a state directory.");
  }
};

ExitCode checkState(const CheckStateOptions& options) {
  Inspection found = inspect(std::filesystem::path(options.directory));
  std::vector<std::string> repaired;
  if (options.repair) {
    // inspect() has refused a directory that is not a state directory: this constructor would turn
    // it into one.
    const StateDirectory held(options.directory);
    found = inspect(held);
    if (!options.json) fmt::print("{}", describe(found, options.directory));
    repaired = repair(held, found);
    for (const std::string& step : repaired)
      if (!options.json) fmt::print("repaired   {}\n", step);
    found = inspect(held);
  }
  fmt::print("{}", options.json ? inspectionJson(found, options.directory, repaired) + '\n'
                                : describe(found, options.directory));
  return found.whole() ? ExitCode::done : ExitCode::failed;
}

}  // namespace

const Verb check_state_verb = {"check", "Check a state directory for damage; repair it",
                               prepareVerb<CheckStateOptions, checkState>};

}  // namespace palpate
