#include <CLI/CLI.hpp>
#include <algorithm>
#include <deque>
#include <memory>
#include <thread>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "scheduler/events/event_log.hpp"
#include "scheduler/events/event_reader.hpp"
#include "scheduler/state/state_directory.hpp"
#include "scheduler/verbs/verbs.hpp"

// `palpate events`: what happened in a state directory, and what happens there now.

namespace palpate {
namespace {

constexpr std::chrono::milliseconds look_every{250};

struct EventsOptions {
  std::string state;
  std::vector<std::string> words;
  std::optional<std::uint32_t> last;
  bool follow = false;
  bool text = false;
};

void checkWords(const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (std::ranges::count(event_words, word) > 0) continue;
    const std::string_view near = nearestWord(word, event_words);
    throw badInput("--event: there is no \"{}\"{}: {}", word,
                   near.empty() ? "" : fmt::format(", is it {}?", near), listed(event_words));
  }
}

void show(std::string_view line, bool as_text) {
  fmt::print("{}\n", as_text ? textOfEvent(line) : line);
}

/// What there is by now: all of it, or the last so many.
void showPast(EventReader& reader, const EventsOptions& options) {
  std::deque<std::string> kept;
  reader.readOn([&](std::string_view line) {
    if (!options.last) return show(line, options.text);
    kept.emplace_back(line);
    if (kept.size() > *options.last) kept.pop_front();
  });
  for (const std::string& line : kept) show(line, options.text);
}

ExitCode showEvents(const EventsOptions& options) {
  checkWords(options.words);
  // What is no state directory has no events, and never will.
  if (!std::filesystem::exists(StateDirectory::databaseIn(options.state)) &&
      eventFiles(options.state).empty())
    throw badInput("\"{}\" is no state directory: that is OUT.h5.state, or what --state said",
                   options.state);
  EventReader reader(options.state, {options.words.begin(), options.words.end()});
  showPast(reader, options);
  if (!options.follow) return ExitCode::done;
  catchInterrupts();
  while (!interrupted()) {
    std::fflush(stdout);
    if (std::ferror(stdout) != 0) throw failure("cannot write to standard output");
    std::this_thread::sleep_for(look_every);
    reader.readOn([&](std::string_view line) { show(line, options.text); });
  }
  return ExitCode::interrupted;
}

std::function<ExitCode()> prepareEvents(CLI::App& app) {
  auto options = std::make_shared<EventsOptions>();
  app.add_option("STATE", options->state, "State directory, whether a scheduler works in it or not")
      ->required();
  app.add_flag("-f,--follow", options->follow, "Then go on with what happens, until interrupted");
  app.add_option("--last", options->last, "Of what happened so far, the last N")->type_name("N");
  app.add_option("--event", options->words, "Only these, separated by commas (docs/commands.md)")
      ->delimiter(',')
      ->type_name("WORD,...");
  app.add_flag("--text", options->text, "For people, instead of one JSON object per line");
  return [options] { return showEvents(*options); };
}

}  // namespace

const Verb events_verb = {"events", "What happened in a build, and what happens now",
                          prepareEvents};

}  // namespace palpate
