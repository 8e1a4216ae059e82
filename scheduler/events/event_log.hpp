#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/file_descriptor.hpp"

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

/// Returns the path of the event file with this number: DIRECTORY/events-000001.jsonl.
std::filesystem::path eventFile(const std::filesystem::path& directory, std::uint32_t number);
/// Returns the numbers of the existing event files, in order.
std::vector<std::uint32_t> eventFiles(const std::filesystem::path& directory);

/// Appends events to the files of a state directory. The caller holds the lock of the directory
/// before the first write.
///
/// Events inform users and programs; no decision depends on them, so nothing here throws or blocks:
/// - Lines are not synced. A crash loses the lines of one turn and leaves at most one partial line,
///   which readers skip.
/// - If lines cannot be written (a full disk), that is logged once and the build goes on. When
///   there is room again, an event gives the number of lost lines.
/// - A file ends at `file_bytes`; the oldest files are removed, so that `most_files` remain.
///
/// One thread.
class EventLog {
 public:
  /// Files of this size and number hold 32 MiB, about 150,000 events. That is enough for a night of
  /// failures, and small beside a journal.
  static constexpr std::uint64_t usual_file_bytes = 4 << 20;
  static constexpr std::uint32_t usual_files = 8;

  /// Opens no file yet.
  explicit EventLog(std::filesystem::path directory, std::uint64_t file_bytes = usual_file_bytes,
                    std::uint32_t most_files = usual_files);
  ~EventLog() { flush(); }

  /// Adds an event with the current time. It is written by the next flush(), or by this call if
  /// many events wait.
  void add(const Event& event);
  /// Writes the waiting lines. Call in every turn; cheap if no line waits.
  void flush();

 private:
  bool open();
  bool beginFile(std::uint32_t number);
  void prune() const;
  bool writeWaiting();
  void lose(const std::string& why);

  std::filesystem::path directory_;
  std::uint64_t file_bytes_;
  std::uint32_t most_files_;
  FileDescriptor file_;
  std::uint32_t number_ = 0;   ///< number of the open file
  std::uint64_t written_ = 0;  ///< size of the open file
  bool half_line_ = false;     ///< the open file ends in a partial line
  std::string waiting_;        ///< complete lines, not yet written
  std::int64_t lines_ = 0;     ///< number of events in waiting_, except "left_out"
  std::int64_t lost_ = 0;      ///< number of events lost since the last successful write
  bool told_ = false;
};

}  // namespace palpate
