#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/file_descriptor.hpp"
#include "scheduler/events/event.hpp"

namespace palpate {

/// The file of events with this number: DIRECTORY/events-000001.jsonl.
std::filesystem::path eventFile(const std::filesystem::path& directory, std::uint32_t number);
/// The numbers of those that are there, in order.
std::vector<std::uint32_t> eventFiles(const std::filesystem::path& directory);

/// Appends events to the files of a state directory, whose lock its owner holds as soon as there is
/// something to keep.
///
/// Events tell people and programs what happened; nothing rests on them. So nothing here throws or
/// waits: lines are not synced, and where they cannot be written (a full disk) that is told once
/// (log), the build goes on, and how many were lost is an event of its own once there is room
/// again. A crash costs the lines of a turn, and leaves half a line at most, which readers skip.
/// Files are cut off at `file_bytes`, and of the oldest so many are removed that `most_files` stay.
/// One thread.
class EventLog {
 public:
  /// Together 32 MiB, some 150000 events: a night of failures, and nothing beside a journal.
  static constexpr std::uint64_t usual_file_bytes = 4 << 20;
  static constexpr std::uint32_t usual_files = 8;

  /// Touches nothing yet.
  explicit EventLog(std::filesystem::path directory, std::uint64_t file_bytes = usual_file_bytes,
                    std::uint32_t most_files = usual_files);
  ~EventLog() { flush(); }
  EventLog(const EventLog&) = delete;
  EventLog& operator=(const EventLog&) = delete;

  /// It happened now. Written with the next flush(), or when a lot waits.
  void add(const Event& event);
  /// Writes what waits. Cheap when nothing does: call it in every turn.
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
  std::uint32_t number_ = 0;   ///< of the file that is open
  std::uint64_t written_ = 0;  ///< bytes of it
  bool half_line_ = false;     ///< at its end
  std::string waiting_;        ///< whole lines
  std::int64_t lines_ = 0;     ///< in it, without what says how many were lost
  std::int64_t lost_ = 0;      ///< lines, since the last that was kept
  bool told_ = false;
};

}  // namespace palpate
