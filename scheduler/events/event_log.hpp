#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/file_descriptor.hpp"
#include "scheduler/events/event.hpp"

namespace palpate {

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
