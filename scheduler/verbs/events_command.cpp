#include <deque>
#include <thread>

#include "common/base/error.hpp"
#include "common/base/required_option.hpp"
#include "scheduler/events/event_log.hpp"
#include "scheduler/events/event_reader.hpp"
#include "scheduler/state/state_directory.hpp"
#include "scheduler/verbs/verbs.hpp"

namespace palpate {
namespace {

constexpr std::chrono::milliseconds look_every{250};

struct EventsOptions {
  std::string state;
  std::vector<std::string> words;
  std::optional<std::uint32_t> last;
  bool follow = false;

  void addTo(CLI::App& app) {
    addRequired(app, "STATE", state, "State directory, with or without a running scheduler");
    app.add_flag("-f,--follow", follow, "Continue with new events until interrupted");
    app.add_option("--last", last, "Print the last N events")->type_name("N");
    app.add_option("--event", words, "Print only these events (docs/commands.md)")
        ->delimiter(',')
        ->type_name("WORD,...")
        ->check(CLI::IsMember(std::vector<std::string>(event_words.begin(), event_words.end())));
  }
};

void printLine(std::string_view line) { fmt::print("{}\n", line); }

/// Prints all past events, or only the last few.
void showPast(EventReader& reader, const std::optional<std::uint32_t>& last) {
  if (!last) return reader.readOn(printLine);
  std::deque<std::string> kept;
  reader.readOn([&](std::string_view line) {
    kept.emplace_back(line);
    if (kept.size() > *last) kept.pop_front();
  });
  for (const std::string& line : kept) printLine(line);
}

ExitCode showEvents(const EventsOptions& options) {
  // Refuse anything that is not a state directory: it has no events and never will.
  if (!std::filesystem::exists(StateDirectory::databaseIn(options.state)) &&
      eventFiles(options.state).empty())
    throw badInput("\"{}\" is not a state directory: give OUT.h5.state or the directory of --state",
                   options.state);
  EventReader reader(options.state, {options.words.begin(), options.words.end()});
  showPast(reader, options.last);
  if (!options.follow) return ExitCode::done;
  catchInterrupts();
  while (!interrupted()) {
    std::fflush(stdout);
    if (std::ferror(stdout) != 0) throw failure("cannot write to standard output");
    std::this_thread::sleep_for(look_every);
    reader.readOn(printLine);
  }
  return ExitCode::interrupted;
}

}  // namespace

const Verb events_verb = {"events", "Print the events of a build",
                          prepareVerb<EventsOptions, showEvents>};

}  // namespace palpate
