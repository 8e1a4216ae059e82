#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/file_descriptor.hpp"

namespace palpate {

/// Position of a record, or, with length 0, the end of the journal, where the next record begins.
struct JournalPosition {
  std::uint32_t segment = 1;  ///< number in segment-NNNNNN.dat, from 1
  std::uint64_t offset = 0;   ///< position of the record's first byte in the segment
  std::uint64_t length = 0;   ///< length of the whole record, bytes
  bool operator==(const JournalPosition&) const = default;
};

struct JournalRecord {
  std::string header;
  std::string payload;
};

/// Thrown if a record cannot be read back as it was written. Only that record is lost: it can be
/// dropped (Journal::drop) and its result computed again. The message names file and offset.
class DamagedRecord : public Error {
 public:
  DamagedRecord(const JournalPosition& where, const std::string& message)
      : Error(ExitCode::failed, message), where_(where) {}
  const JournalPosition& where() const { return where_; }

 private:
  JournalPosition where_;
};

/// A part of a journal that contains no whole record.
struct JournalGap {
  enum class Kind : std::uint8_t {
    damaged,  ///< no record can be read there
    missing,  ///< the whole segment is missing
    dropped,  ///< marked as dropped, so that no scan finds a record there
  };
  Kind kind = Kind::damaged;
  JournalPosition where;  ///< has length 0 if it is the whole segment
  std::string text;       ///< message with the name of the file
};

/// The findings of a scan, apart from the records.
struct JournalScan {
  /// Gaps between the records. The bytes after the last record are not a gap, because a crash may
  /// leave some there.
  std::vector<JournalGap> gaps;
  /// Records of the last segment that have an undamaged header and a damaged payload, and are
  /// followed by further records. A crash leaves such records if only part of an unsynced write
  /// reached the disk. They must be dropped before the next segment is started, because in older
  /// segments a scan checks only the headers.
  std::vector<JournalPosition> torn;
  JournalPosition end;  ///< end of the last record
};

class SegmentFile;  // one segment, open for reading

/// Reads the journal in a directory: DIRECTORY/segment-000001.dat and so on.
///
/// Layout of a record (docs/internals/state.md):
/// - "PJR3";
/// - header bytes, u32;
/// - payload bytes, u32;
/// - CRC-32 over the record's place (segment and offset), the two lengths and the header, u32;
/// - CRC-32 over the payload, u32;
/// - header;
/// - payload.
///
/// Only reads these files. A scheduler may append to them meanwhile. Keeps open the segment that it
/// read last. One thread.
class JournalReader {
 public:
  explicit JournalReader(std::filesystem::path directory) : directory_(std::move(directory)) {}

  /// Receives the place and undamaged header of a record. `header` is valid only during the call.
  using Visit = std::function<void(const JournalPosition& where, std::string_view header)>;
  /// Finds all records, even between damaged bytes, and passes them to `visit` in the order of
  /// appending. Reads the header of every record. In the last segment, where a crash may leave a
  /// partial record, reads and checks the payloads too.
  JournalScan scan(const Visit& visit) const;
  /// Reads a record. Throws DamagedRecord if the record is missing or is not what was written.
  JournalRecord read(const JournalPosition& position) const;
  /// Reads the header of a record; throws like read().
  std::string readHeader(const JournalPosition& position) const;
  /// Returns the current total size, in bytes, of the segments before `segment`.
  std::uint64_t bytesBefore(std::uint32_t segment) const;
  /// Returns the numbers of the existing segments, sorted.
  std::vector<std::uint32_t> segments() const;
  std::filesystem::path segmentPath(std::uint32_t segment) const;

 protected:
  std::filesystem::path directory_;

 private:
  const SegmentFile& fileWith(const JournalPosition& position) const;

  mutable std::shared_ptr<const SegmentFile> latest_;
};

/// Appends results to the journal. A record is durable once sync() has returned. One thread. After
/// a failed write or sync the journal must not be used: it is unknown which part of the failed
/// write the kernel kept.
class Journal : public JournalReader {
 public:
  static constexpr std::uint64_t default_segment_bytes = 256ull << 20;

  /// Opens the journal for appending at `end` (JournalScan::end). Truncates the segment there,
  /// which removes only what a crash left after the last whole record. Syncs all segments, so that
  /// records and drop marks that a killed run left unsynced become durable.
  Journal(std::filesystem::path directory, JournalPosition end,
          std::uint64_t segment_bytes = default_segment_bytes);

  /// Appends a record. The record may stay in memory until sync(). If the open segment is full,
  /// syncs and closes it first.
  JournalPosition append(std::string_view header, std::string_view payload);
  /// Writes and syncs (fdatasync) everything that was appended: everything before end() then
  /// survives a crash. If this fails, cuts off the bytes appended since the last sync, and throws.
  void sync();
  JournalPosition end() const { return end_; }
  /// Size of all segments up to end().
  std::uint64_t bytes() const { return closed_bytes_ + end_.offset; }

  /// Marks records and unreadable gaps as dropped, so that no later scan finds a record there. The
  /// marks are durable on return. Syncs each segment once.
  void dropAll(std::vector<JournalPosition> positions);
  void drop(const JournalPosition& position) { dropAll({position}); }
  /// Creates empty files in place of missing segments, which marks those as dropped.
  void fillMissing();
  /// Throws if a segment was removed, or if the open segment was replaced by another file.
  void checkPresence() const;

 private:
  void openSegment();
  void syncOthers() const;
  void dropIn(std::uint32_t segment, std::span<const JournalPosition> positions);
  void writePending();

  std::uint64_t segment_bytes_;
  JournalPosition end_;
  std::uint64_t closed_bytes_;          ///< total size of the segments before the open one
  std::uint64_t synced_;                ///< bytes of the open segment that survive a crash
  std::vector<std::uint32_t> present_;  ///< segments found at opening or created since
  FileDescriptor file_;                 ///< the open segment
  /// Appended bytes that are not in the file yet, collected so that one write covers many records.
  std::string pending_;
};

}  // namespace palpate
