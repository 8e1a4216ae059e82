#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "scheduler/state/file_descriptor.hpp"

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

/// Every result, append-only, in DIRECTORY/segment-000001.dat and so on. Layout of a record
/// (docs/state.md): "PJR1", header bytes u32, payload bytes u32, CRC-32 u32 over the two lengths,
/// the header and the payload; header; payload.
///
/// A record counts once sync() returned *and* the caller has stored end() durably; what lies behind
/// the stored end after a crash is cut off when the journal is opened. One thread. Every failure of
/// a write or a sync is an Error after which the journal must not be used: what the kernel kept of
/// the failed write is unknown.
class Journal {
 public:
  static constexpr std::uint64_t default_segment_bytes = 256ull << 20;

  /// Opens for appending at `committed`; truncates the segment there and removes later segments.
  /// Error when the journal is shorter than that: something committed is missing.
  Journal(std::filesystem::path directory, JournalEnd committed,
          std::uint64_t segment_bytes = default_segment_bytes);

  /// Appends without syncing. A full segment is synced and closed first.
  JournalPosition append(std::string_view header, std::string_view payload);
  /// fdatasync; afterwards everything before end() survives a crash.
  void sync();
  JournalEnd end() const { return end_; }

  /// Reads a record back. Error, naming file and offset, when it is damaged or missing.
  JournalRecord read(const JournalPosition& position) const;

 private:
  std::filesystem::path segmentPath(std::uint32_t segment) const;
  void openSegment(bool create);
  void writeAll(std::string_view bytes);

  std::filesystem::path directory_;
  std::uint64_t segment_bytes_;
  JournalEnd end_;
  FileDescriptor file_;
};

}  // namespace palpate
