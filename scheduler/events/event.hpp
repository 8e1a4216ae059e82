#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <concepts>
#include <string>
#include <string_view>

namespace palpate {

/// All events that a build can have, as they are spelled in the files. docs/commands.md lists the
/// fields of each event.
inline constexpr auto event_words = std::to_array<std::string_view>({
    "started",         // a scheduler starts, or reads the records again
    "stopped",         // a scheduler ends without a dataset
    "completed",       // everything is computed and checked
    "sealed",          // the dataset is written
    "stage",           // a space enters a stage
    "failed_attempt",  // a transition found no equilibrium
    "set_aside",       // a transition is no longer handed out: workers died on it
    "retried",         // transitions that were set aside or failed are handed out again
    "priority",        // the priority of a space changed
    "paused",         "resumed",
    "disputed",  // two workers returned different bits for one transition
    "kept_out",  // a worker, machine or key is excluded: its results were wrong
    "damaged",   // a record is no longer readable
    "worker_joined",  "worker_left",
    "worker_lost",     // a worker fell silent
    "worker_ended",    // the process of a worker ended by itself
    "worker_refused",  // a worker was not allowed to join
    "left_out",        // events were lost: too many at once, or no room on the disk
});

/// A word of event_words. Any other word is a compile-time error.
class EventWord {
 public:
  consteval EventWord(const char* word) : word_(word) {
    if (std::ranges::find(event_words, word_) == event_words.end()) throw "no such event";
  }
  operator std::string_view() const { return word_; }

 private:
  std::string_view word_;
};

/// An event and its fields, in the order in which they were added. Has no clock: the caller of
/// line() gives the time.
class Event {
 public:
  explicit Event(EventWord word) : word_(word) {}

  /// Invalid UTF-8 is replaced by U+FFFD.
  Event& with(std::string_view field, std::string_view text);
  /// Numbers that are not finite become null.
  Event& with(std::string_view field, double number);
  /// A lattice point, in spacings, as `palpate explain` accepts it.
  Event& with(std::string_view field, const std::array<double, 3>& place);
  /// An integer or a boolean.
  template <std::integral Number>
  Event& with(std::string_view field, Number number) {
    if constexpr (std::same_as<Number, bool>) return addJson(field, number ? "true" : "false");
    return addJson(field, std::to_string(number));
  }

  /// Returns one JSON object on one line, without a line feed. The time is formatted by utcText().
  std::string line(std::chrono::system_clock::time_point when) const;

 private:
  Event& addJson(std::string_view field, std::string_view json);

  std::string_view word_;
  std::string fields_;  ///< the fields as JSON, each with a comma before it
};

}  // namespace palpate
