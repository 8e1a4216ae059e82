#include "scheduler/events/event_log.hpp"
#include "scheduler/events/event_reader.hpp"
#include "tests/fuzz/fuzzer.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate::fuzz {
namespace {

const std::chrono::system_clock::time_point now(std::chrono::seconds(1795551479));

/// A state directory that contains only events.
const std::filesystem::path& directory() {
  static const test::TemporaryDirectory made;
  return made.path();
}

/// The first line is the requested event word, the rest an event file.
void readEvents(std::string_view bytes) {
  const std::size_t end = std::min(bytes.find('\n'), bytes.size());
  const std::string word(bytes.substr(0, end));
  putInto(eventFile(directory(), 1), bytes.substr(std::min(end + 1, bytes.size())));
  WantedEvents wanted;
  if (!word.empty()) wanted.insert(word);
  std::vector<std::string> taken;
  EventReader(directory(), wanted).readOn([&](std::string_view line) {
    require(line.find('\n') == std::string_view::npos, "a line is one line");
    taken.emplace_back(line);
  });
  require(lastEvents(directory(), wanted, taken.size() + 1) == taken,
          "events are the same read from the beginning and from the end");
}

std::vector<std::string> eventSeeds() {
  std::string events;
  for (const Event& event :
       {Event("started").with("scene", "liver").with("pid", 17).with("paused", false),
        Event("failed_attempt")
            .with("space", "tip")
            .with("cause", "step_budget")
            .with("worker", "0a1b2c3d")
            .with("point", {1, -0.5, 0})
            .with("step_reached", 0.25),
        Event("worker_left").with("host", "a\"b\\c\n{}\x1b[2J\xff")})
    events += event.line(now) + '\n';
  return {'\n' + events, "started\n" + events,
          "failed_attempt\n" + events + R"({"time":"2026-11-24T20)"};
}

const Registration events_fuzzer({"events", readEvents, eventSeeds});

}  // namespace
}  // namespace palpate::fuzz
