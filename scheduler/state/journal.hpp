#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/file_descriptor.hpp"

namespace palpate {

/// Where one record lies.
struct JournalPosition {
  std::uint32_t segment = 0;  ///< of segment-NNNNNN.dat, from 1
  std::uint64_t offset = 0;   ///< of the record's first byte
  std::uint64_t length = 0;   ///< of the whole record, bytes
  bool operator==(const JournalPosition&) const = default;
};

/// Where the journal ends: the next record begins here.
struct JournalEnd {
  std::uint32_t segment = 1;
  std::uint64_t offset = 0;
  bool operator==(const JournalEnd&) const = default;
};

struct JournalRecord {
  std::string header;
  std::string payload;
};

/// A record is not what was written, and costs itself: it can be dropped (Journal::drop) and
/// computed again. The message names file and offset.
class DamagedRecord : public Error {
 public:
  DamagedRecord(const JournalPosition& where, const std::string& message)
      : Error(ExitCode::failed, message), where_(where) {}
  const JournalPosition& where() const { return where_; }

 private:
  JournalPosition where_;
};

/// A stretch of a journal that holds no whole record.
struct JournalGap {
  enum class Kind : std::uint8_t {
    damaged,  ///< no record can be read there
    missing,  ///< the whole segment
    dropped,  ///< it was damaged or missing, and marked so: nobody looks for a record there again
  };
  Kind kind = Kind::damaged;
  JournalPosition where;  ///< length 0: the whole segment
  std::string text;       ///< for people, with the file
};

/// What is in a journal.
struct JournalScan {
  struct Found {
    JournalPosition where;
    std::string header;
  };
  /// Records whose header is whole, in the order of appending; those of the last segment with a
  /// whole payload too. None where they are visited instead.
  std::vector<Found> records;
  /// Stretches between them. Not what lies behind the last record, which a crash may leave.
  std::vector<JournalGap> gaps;
  /// Of the last segment, between records: the header is whole and the payload is not, since the
  /// disk kept one part of what was never synced and not the other. To be dropped before there is
  /// another segment, where only headers are looked at.
  std::vector<JournalPosition> torn;
  JournalEnd end;  ///< behind the last record
};

class SegmentFile;  // of one segment, open for reading

/// The journal in a directory, for reading: DIRECTORY/segment-000001.dat and so on. Layout of a
/// record (docs/state.md): "PJR3", header bytes u32, payload bytes u32, CRC-32 u32 over the
/// record's place, the two lengths and the header, CRC-32 u32 over the payload; header; payload.
///
/// Reading depends on nothing but these files. It may go on while a scheduler appends. The segment
/// that was read last stays open. One thread.
class JournalReader {
 public:
  explicit JournalReader(std::filesystem::path directory) : directory_(std::move(directory)) {}

  /// Finds all records, whatever lies between them. Reads every header, and of the last segment,
  /// where a crash leaves half a record, all. Error (bad input) when an older Palpate wrote them.
  JournalScan scan() const;
  /// The same without keeping the records: they may be more than fit into memory. A header is there
  /// as long as the call.
  using Visit = std::function<void(const JournalPosition& where, std::string_view header)>;
  JournalScan scan(const Visit& visit) const;
  /// Reads a record back. DamagedRecord when it is not what was written, or not there.
  JournalRecord read(const JournalPosition& position) const;
  /// Its header alone, likewise.
  std::string readHeader(const JournalPosition& position) const;
  /// Of the segments with smaller numbers, as they are now.
  std::uint64_t bytesBefore(std::uint32_t segment) const;
  /// The numbers of the segments that are there, in order.
  std::vector<std::uint32_t> segments() const;
  std::filesystem::path segmentPath(std::uint32_t segment) const;

 protected:
  std::filesystem::path directory_;

 private:
  const SegmentFile& fileWith(const JournalPosition& position) const;

  mutable std::shared_ptr<const SegmentFile> latest_;
};

/// Every result, append-only. A record counts once sync() has returned. One thread. Every failure
/// of a write or a sync is an Error after which the journal must not be used: what the kernel kept
/// of the failed write is unknown.
class Journal : public JournalReader {
 public:
  static constexpr std::uint64_t default_segment_bytes = 256ull << 20;

  /// Opens for appending at `end` (JournalScan::end): truncates the segment there, which holds half
  /// a record at most, and syncs all segments, so that what a killed run left counts from now on,
  /// marks of dropped records too.
  Journal(std::filesystem::path directory, JournalEnd end,
          std::uint64_t segment_bytes = default_segment_bytes);

  /// Appends; nothing need be in the file before sync(). A full segment is synced and closed first.
  JournalPosition append(std::string_view header, std::string_view payload);
  /// Writes what was appended, and fdatasync; afterwards everything before end() survives a crash.
  /// When it fails, what was appended since the last one is cut off.
  void sync();
  JournalEnd end() const { return end_; }
  /// Of all segments, up to end().
  std::uint64_t bytes() const { return closed_bytes_ + end_.offset; }

  /// Marks damaged records, or stretches where none can be read, so that no later scan takes what
  /// is there for a result. Durable when it returns; each segment is synced once.
  void dropAll(std::vector<JournalPosition> positions);
  void drop(const JournalPosition& position) { dropAll({position}); }
  /// Puts empty files in the place of segments that are missing, which marks them likewise.
  void fillMissing();
  /// Error when a segment was removed, or the one that is written was replaced by another file.
  void checkPresence() const;

 private:
  void openSegment();
  void syncOthers() const;
  void dropIn(std::uint32_t segment, std::span<const JournalPosition> positions);
  void writePending();

  std::uint64_t segment_bytes_;
  JournalEnd end_;
  std::uint64_t closed_bytes_;  ///< of the segments before it
  std::uint64_t synced_;        ///< of the segment that is written, so many bytes survive a crash
  std::vector<std::uint32_t> present_;  ///< segments that were there, or were made
  FileDescriptor file_;                 ///< of the one that is written
  /// The last bytes before end_, which are not in the file yet: one write for many records.
  std::string pending_;
};

}  // namespace palpate
