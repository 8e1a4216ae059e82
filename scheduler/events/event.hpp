#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

namespace palpate {

/// What can happen in a build: the closed list, as it stands in the files. docs/commands.md says of
/// each which fields it has.
inline constexpr auto event_words = std::to_array<std::string_view>({
    "started",         // a scheduler begins, or goes over what is recorded once more
    "stopped",         // and ends before the dataset is there
    "completed",       // everything is computed and checked
    "sealed",          // the dataset is written
    "stage",           // a space enters a stage
    "failed_attempt",  // a transition found no equilibrium
    "set_aside",       // a transition is handed out no more: workers ended on it
    "retried",         // what was set aside, or failed, is handed out again
    "priority",        // a space is computed before others, or not any more
    "paused",         "resumed",
    "disputed",  // two workers found different bits
    "kept_out",  // whose results were wrong
    "damaged",   // a record cannot be read any more
    "worker_joined",  "worker_left",
    "worker_lost",     // it went without a word
    "worker_ended",    // its process ended by itself
    "worker_refused",  // it may not join
    "left_out",        // so many events were not kept: too many at once, or no room for them
});

/// One of event_words, which the compiler checks.
class EventWord {
 public:
  consteval EventWord(const char* word) : word_(word) {
    if (std::ranges::find(event_words, word_) == event_words.end()) throw "no such event";
  }
  operator std::string_view() const { return word_; }

 private:
  std::string_view word_;
};

/// One thing that happened, and its fields in the order in which they were added. No clock: whoever
/// keeps it says when it was.
class Event {
 public:
  explicit Event(EventWord word) : word_(word) {}

  /// Text that is not UTF-8 is kept as far as it is.
  Event& with(std::string_view field, std::string_view text);
  /// What is not finite becomes null.
  Event& with(std::string_view field, double number);
  /// A place in a lattice, in spacings, as `palpate explain` takes it.
  Event& with(std::string_view field, const std::array<double, 3>& place);
  /// A whole number, or true and false.
  template <std::integral Number>
  Event& with(std::string_view field, Number number) {
    if constexpr (std::same_as<Number, bool>) return addJson(field, number ? "true" : "false");
    return addJson(field, std::to_string(number));
  }

  /// One JSON object in one line, without the line feed. The time as utcText.
  std::string line(std::chrono::system_clock::time_point when) const;

 private:
  Event& addJson(std::string_view field, std::string_view json);

  std::string_view word_;
  std::string fields_;  ///< JSON, each with a comma before it
};

}  // namespace palpate
