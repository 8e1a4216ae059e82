#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace palpate {

/// What can happen in a build: the closed list. The words of name() are what stands in the files;
/// docs/commands.md says of each which fields it has.
enum class EventKind : std::uint8_t {
  started,         ///< a scheduler begins, or goes over what is recorded once more
  stopped,         ///< and ends before the dataset is there
  completed,       ///< everything is computed and checked
  sealed,          ///< the dataset is written
  stage,           ///< a space enters a stage
  failed_attempt,  ///< a transition found no equilibrium
  set_aside,       ///< a transition is handed out no more: workers ended on it
  retried,         ///< what was set aside, or failed, is handed out again
  priority,        ///< a space is computed before others, or not any more
  paused,
  resumed,
  disputed,  ///< two workers found different bits
  kept_out,  ///< whose results were wrong
  damaged,   ///< a record cannot be read any more
  worker_joined,
  worker_left,
  worker_lost,     ///< it went without a word
  worker_ended,    ///< its process ended by itself
  worker_refused,  ///< it may not join
  left_out,        ///< so many events were not kept: too many at once, or no room for them
};

/// "started", "failed_attempt", ...
std::string_view name(EventKind kind);
/// All of those words, in order.
std::span<const std::string_view> eventWords();

/// One thing that happened, and its fields in the order in which they were added. No clock: whoever
/// keeps it says when it was.
class Event {
 public:
  explicit Event(EventKind kind) : kind_(kind) {}

  EventKind kind() const { return kind_; }
  /// Text that is not UTF-8 is kept as far as it is.
  Event& with(std::string_view field, std::string_view text);
  Event& with(std::string_view field, std::int64_t number);
  /// What is not finite becomes null.
  Event& with(std::string_view field, double number);
  Event& with(std::string_view field, bool yes);
  /// A place in a lattice, in spacings, as `palpate explain` takes it.
  Event& with(std::string_view field, const std::array<double, 3>& place);
  /// Else a pointer would be a bool.
  Event& with(std::string_view field, const char* text) {
    return with(field, std::string_view(text));
  }

  /// One JSON object in one line, without the line feed. The time as utcText.
  std::string line(std::chrono::system_clock::time_point when) const;

 private:
  Event& addValue(std::string_view field, std::string_view json);

  EventKind kind_;
  std::string fields_;  ///< JSON, each with a comma before it
};

}  // namespace palpate
