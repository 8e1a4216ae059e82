#include "scheduler/state/journal.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "common/base/assertion.hpp"
#include "common/base/number_in.hpp"
#include "common/base/whole_file.hpp"

namespace palpate {
namespace {

/// The largest number of six digits. With default_segment_bytes, a journal can thus have 256 TB.
constexpr std::uint32_t most_segments = 999999;

/// The beginning of a record, of fixed size. The header and the payload follow.
struct Head {
  static constexpr std::string_view whole = "PJR3", dropped = "PJRX";

  std::array<char, 4> magic = {'P', 'J', 'R', '3'};
  std::uint32_t header_bytes = 0, payload_bytes = 0;
  std::uint32_t header_crc = 0;  ///< over the record's place, the two lengths and the header
  std::uint32_t payload_crc = 0;

  bool is(std::string_view kind) const {
    return std::string_view(magic.data(), magic.size()) == kind;
  }
  std::uint64_t recordBytes() const {
    return sizeof(Head) + std::uint64_t{header_bytes} + payload_bytes;
  }
};
static_assert(sizeof(Head) == 20, "docs/internals/state.md states this size");

std::uint32_t crcOf(std::string_view bytes, uLong before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::uint32_t crcOf(std::span<const std::uint32_t> numbers, uLong before = 0) {
  return crcOf({reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()}, before);
}

/// `place` is the result of placeCrcOf().
std::uint32_t headerCrcOf(const Head& head, std::string_view header, std::uint32_t place) {
  const std::array<std::uint32_t, 2> lengths = {head.header_bytes, head.payload_bytes};
  return crcOf(header, crcOf(lengths, place));
}

/// Returns the checksum of a record's place. It is part of the header's checksum, so a copy of a
/// record is invalid at any other place, for instance in the payload of another record.
std::uint32_t placeCrcOf(std::uint32_t segment, std::uint64_t offset) {
  const std::array<std::uint32_t, 3> place = {segment, static_cast<std::uint32_t>(offset),
                                              static_cast<std::uint32_t>(offset >> 32)};
  return crcOf(place);
}

}  // namespace

class SegmentFile {
 public:
  SegmentFile(std::filesystem::path path, std::uint32_t number)
      : path_(std::move(path)), number_(number), file_(open(path_.c_str(), O_RDONLY | O_CLOEXEC)) {
    struct stat info {};
    if (file_ && fstat(file_.get(), &info) != 0)
      throw failure("{}: cannot stat: {}", path_.string(), errnoText());
    if (!file_ && errno != ENOENT)
      throw failure("{}: cannot open: {}", path_.string(), errnoText());
    bytes_ = file_ ? static_cast<std::uint64_t>(info.st_size) : 0;
  }

  bool exists() const { return static_cast<bool>(file_); }
  /// Discards the read buffer, so that later reads see the bytes now on disk. size() remains the
  /// size at opening.
  void lookAgain() const { window_.clear(); }
  std::uint64_t size() const { return bytes_; }
  const std::filesystem::path& path() const { return path_; }
  std::uint32_t number() const { return number_; }

  /// Returns up to `length` bytes at `offset`. Returns fewer bytes at the end of the file, or
  /// before a sector that the disk cannot read, which counts as damage.
  std::string read(std::uint64_t offset, std::uint64_t length) const {
    length = offset < bytes_ ? std::min(length, bytes_ - offset) : 0;
    std::string bytes(length, '\0');
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t n = pread(file_.get(), bytes.data() + done, bytes.size() - done,
                              static_cast<off_t>(offset + done));
      if (n < 0 && errno == EINTR) continue;
      if (n < 0 && errno != EIO) throw failure("{}: cannot read: {}", path_.string(), errnoText());
      if (n <= 0) break;
      done += static_cast<std::size_t>(n);
    }
    bytes.resize(done);
    return bytes;
  }

  /// Returns the Head and the header of the record at `offset`; none if either is damaged or if the
  /// record would not fit into the file.
  std::optional<std::pair<Head, std::string>> headAt(std::uint64_t offset) const {
    Head head;
    const std::string_view bytes = peek(offset, sizeof head);
    if (bytes.size() < sizeof head) return std::nullopt;
    std::memcpy(&head, bytes.data(), sizeof head);
    if (!head.is(Head::whole) && !head.is(Head::dropped)) return std::nullopt;
    if (head.recordBytes() > bytes_ - offset) return std::nullopt;
    const std::string_view header = peek(offset + sizeof head, head.header_bytes);
    const std::uint32_t place = placeCrcOf(number_, offset);
    if (header.size() != head.header_bytes || headerCrcOf(head, header, place) != head.header_crc)
      return std::nullopt;
    return std::pair(head, std::string(header));
  }
  bool payloadIsWhole(std::uint64_t offset, const Head& head) const {
    const std::string_view payload =
        peek(offset + sizeof head + head.header_bytes, head.payload_bytes);
    return payload.size() == head.payload_bytes && crcOf(payload) == head.payload_crc;
  }

  /// Returns the offset of the next record at or after `offset`; the end of the file if there is
  /// none.
  std::uint64_t findRecord(std::uint64_t offset) const {
    constexpr std::uint64_t window = 1u << 20;
    constexpr std::string_view common_part = Head::whole.substr(0, 3);
    while (offset < bytes_) {
      // Windows overlap by one byte less than the searched text, so that no occurrence is missed.
      const std::string bytes = read(offset, window);
      for (std::size_t at = bytes.find(common_part); at != std::string::npos;
           at = bytes.find(common_part, at + 1))
        if (headAt(offset + at)) return offset + at;
      // Skip unreadable data page by page: disks lose data in whole pages.
      constexpr std::uint64_t page = 4096;
      const bool whole = bytes.size() == std::min(window, bytes_ - offset);
      offset = whole ? offset + window - (common_part.size() - 1)
                     : ((offset + bytes.size()) / page + 1) * page;
    }
    return bytes_;
  }

 private:
  /// Does the same as read(), but the bytes are valid only until the next call. Buffers sequential
  /// reads: small records then need no system call each, and for large records little more than the
  /// head is read.
  std::string_view peek(std::uint64_t offset, std::uint64_t length) const {
    constexpr std::uint64_t page = 4096, most_ahead = 64 * page;
    const std::uint64_t end = window_at_ + window_.size();
    if (offset < window_at_ || offset + length > end) {
      const bool goes_on = offset >= window_at_ && offset <= end;
      ahead_ = goes_on ? std::clamp(2 * ahead_, page, most_ahead) : page;
      window_at_ = offset;
      window_ = read(offset, std::max(length, ahead_));
      // If a sector after the requested bytes is unreadable, read again without the extra bytes.
      if (window_.size() < std::min(length, bytes_ - std::min(offset, bytes_)))
        window_ = read(offset, length);
    }
    return std::string_view(window_).substr(offset - window_at_, length);
  }

  std::filesystem::path path_;
  std::uint32_t number_;
  FileDescriptor file_;
  std::uint64_t bytes_ = 0;
  mutable std::string window_;  ///< bytes of the last read
  mutable std::uint64_t window_at_ = 0, ahead_ = 0;
};

namespace {

std::string segmentName(std::uint32_t segment) { return fmt::format("segment-{:06}.dat", segment); }

/// Returns the numbers of the segments in a directory, sorted. Accepts only names exactly as
/// segmentName() writes them. Another spelling would be a second file with the same number, and a
/// huge number would imply that all segments before it are missing.
std::vector<std::uint32_t> segmentsIn(const std::filesystem::path& directory) {
  std::vector<std::uint32_t> numbers;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    const std::string name = entry.path().filename().string();
    const auto number = numberBetween<std::uint32_t>("segment-", name, ".dat");
    if (number && *number > 0 && *number <= most_segments && name == segmentName(*number))
      numbers.push_back(*number);
  }
  std::ranges::sort(numbers);
  return numbers;
}

void scanSegment(const SegmentFile& file, bool last, const JournalReader::Visit& visit,
                 JournalScan& found) {
  using Kind = JournalGap::Kind;
  const std::uint32_t number = file.number();
  const auto gap = [&](Kind kind, std::uint64_t from, std::uint64_t to, const char* what) {
    found.gaps.push_back(
        {kind,
         {number, from, to - from},
         fmt::format("{}: bytes {} to {}: {}", file.path().string(), from, to, what)});
  };
  const auto stretch = [&](std::uint64_t from, std::uint64_t to) {
    // A gap shorter than a head may hold the beginning of the mark of a dropped record (markFor).
    if (to - from < sizeof(Head) &&
        file.read(from, to - from).starts_with(Head::dropped.substr(0, to - from)))
      gap(Kind::dropped, from, to, "too short for a record; dropped earlier");
    else
      gap(Kind::damaged, from, to, "no record can be read there");
  };
  std::uint64_t behind_last = 0;
  for (std::uint64_t at = 0; at < file.size();) {
    auto record = file.headAt(at);
    if (!record) {
      at = file.findRecord(at + 1);
      continue;
    }
    auto& [head, header] = *record;
    const std::uint64_t next = at + head.recordBytes();
    const bool torn = last && head.is(Head::whole) && !file.payloadIsWhole(at, head);
    if (torn) {
      found.torn.push_back({number, at, next - at});
    } else {
      if (at > behind_last) stretch(behind_last, at);
      if (head.is(Head::dropped))
        gap(Kind::dropped, at, next, "a record that was dropped earlier");
      else
        visit({number, at, next - at}, header);
      behind_last = next;
    }
    at = next;
  }
  if (!last && behind_last < file.size()) stretch(behind_last, file.size());
  // An empty segment before the last one stands in for a missing segment.
  if (!last && file.size() == 0) gap(Kind::dropped, 0, 0, "empty in place of a missing segment");
  found.end = {number, behind_last};
  // Torn records after the last whole record need not be dropped: their bytes are cut off.
  std::erase_if(found.torn,
                [&](const JournalPosition& torn) { return torn.offset >= behind_last; });
}

/// Returns the bytes that mark a record as dropped, to be written over its head.
///
/// - If the lengths in the head can be read, only the magic word is replaced; the rest of the head
///   stays.
/// - Otherwise the bytes are a new head, whose record spans the whole gap.
/// - In a gap shorter than a head, they are the part of the magic word that fits, because a whole
///   record follows.
std::string markFor(const SegmentFile& file, const JournalPosition& position) {
  const auto there = file.headAt(position.offset);
  const bool lengths_known = there && there->first.recordBytes() == position.length;
  if (lengths_known || position.length < sizeof(Head))
    return std::string(Head::dropped.substr(0, position.length));
  Head head{.magic = {'P', 'J', 'R', 'X'},
            .payload_bytes = static_cast<std::uint32_t>(position.length - sizeof(Head))};
  head.header_crc = headerCrcOf(head, "", placeCrcOf(position.segment, position.offset));
  return {reinterpret_cast<const char*>(&head), sizeof head};
}

DamagedRecord damaged(const SegmentFile& file, const JournalPosition& position, const char* what) {
  return {position, fmt::format("{}: the record at byte {} is damaged ({})", file.path().string(),
                                position.offset, what)};
}

/// Returns the head and the header of a record.
std::pair<Head, std::string> recordAt(const SegmentFile& file, const JournalPosition& position) {
  auto record = file.headAt(position.offset);
  if (!file.exists()) throw damaged(file, position, "the file is missing");
  if (!record || !record->first.is(Head::whole))
    throw damaged(file, position, "its head or its header");
  if (record->first.recordBytes() != position.length)
    throw damaged(file, position, "another record is there");
  return std::move(*record);
}

}  // namespace

std::vector<std::uint32_t> JournalReader::segments() const { return segmentsIn(directory_); }

std::uint64_t JournalReader::bytesBefore(std::uint32_t segment) const {
  std::uint64_t bytes = 0;
  for (const std::uint32_t number : segments()) {
    std::error_code gone;
    const std::uintmax_t size = std::filesystem::file_size(segmentPath(number), gone);
    if (number < segment && !gone) bytes += size;
  }
  return bytes;
}

std::filesystem::path JournalReader::segmentPath(std::uint32_t segment) const {
  return directory_ / segmentName(segment);
}

JournalScan JournalReader::scan(const Visit& visit) const {
  JournalScan found;
  std::uint32_t expected = 1;
  const std::vector<std::uint32_t> numbers = segmentsIn(directory_);
  for (const std::uint32_t number : numbers) {
    for (; expected < number; ++expected)
      found.gaps.push_back({JournalGap::Kind::missing,
                            {.segment = expected},
                            fmt::format("{}: is missing", segmentPath(expected).string())});
    ++expected;
    scanSegment(SegmentFile(segmentPath(number), number), number == numbers.back(), visit, found);
  }
  return found;
}

/// Returns the segment of a record, and keeps it open for the next call. Records are read in the
/// order of points and were recorded from rest outward, so most lie in the same segment as the
/// record before.
const SegmentFile& JournalReader::fileWith(const JournalPosition& position) const {
  const std::uint64_t end = position.offset + position.length;
  if (!latest_ || latest_->number() != position.segment || latest_->size() < end)
    latest_ = std::make_shared<SegmentFile>(segmentPath(position.segment), position.segment);
  latest_->lookAgain();
  return *latest_;
}

JournalRecord JournalReader::read(const JournalPosition& position) const {
  const SegmentFile& file = fileWith(position);
  auto [head, header] = recordAt(file, position);
  std::string payload =
      file.read(position.offset + sizeof head + head.header_bytes, head.payload_bytes);
  if (payload.size() != head.payload_bytes || crcOf(payload) != head.payload_crc)
    throw damaged(file, position, "its payload");
  return {std::move(header), std::move(payload)};
}

std::string JournalReader::readHeader(const JournalPosition& position) const {
  return recordAt(fileWith(position), position).second;
}

Journal::Journal(std::filesystem::path directory, JournalPosition end, std::uint64_t segment_bytes)
    : JournalReader(std::move(directory)),
      segment_bytes_(segment_bytes),
      end_(end),
      closed_bytes_(bytesBefore(end.segment)),
      synced_(end.offset) {
  present_ = segmentsIn(directory_);
  openSegment();
  if (ftruncate(file_.get(), static_cast<off_t>(end.offset)) != 0)
    throw failure("{}: cannot truncate: {}", segmentPath(end_.segment).string(), errnoText());
  syncOthers();
  sync();
  syncFolder(directory_);
}

JournalPosition Journal::append(std::string_view header, std::string_view payload) {
  if (end_.offset >= segment_bytes_) {
    sync();
    // The sync above is needed now, because later syncs reach only the open segment.
    if (end_.segment == most_segments)
      throw failure("{}: is the last segment a journal can have: use another --state directory",
                    segmentPath(end_.segment).string());
    ++end_.segment;
    closed_bytes_ += end_.offset;
    end_.offset = synced_ = 0;
    openSegment();
    syncFolder(directory_);
  }
  PALPATE_ASSERT(std::max(header.size(), payload.size()) <= UINT32_MAX,
                 "a message and its payload must be below 4 GiB");
  Head head{.header_bytes = static_cast<std::uint32_t>(header.size()),
            .payload_bytes = static_cast<std::uint32_t>(payload.size()),
            .payload_crc = crcOf(payload)};
  head.header_crc = headerCrcOf(head, header, placeCrcOf(end_.segment, end_.offset));
  const JournalPosition position{end_.segment, end_.offset,
                                 sizeof head + header.size() + payload.size()};
  pending_.append(reinterpret_cast<const char*>(&head), sizeof head);
  pending_ += header;
  pending_ += payload;
  end_.offset += position.length;
  constexpr std::size_t enough = 1 << 20;
  if (pending_.size() >= enough) writePending();
  return position;
}

void Journal::sync() {
  writePending();
  if (fdatasync(file_.get()) == 0) {
    synced_ = end_.offset;
    return;
  }
  const std::string reason = errnoText();
  // Do not try again: the kernel may treat the lost pages as written from now on. The next run
  // would read them from memory and rely on them, so they are cut off.
  const bool cut_off = ftruncate(file_.get(), static_cast<off_t>(synced_)) == 0;
  throw failure(
      "{}: cannot flush to the disk ({}): workers must deliver the latest results again{}",
      segmentPath(end_.segment).string(), reason,
      cut_off ? "" : fmt::format(" (cut the file to {} bytes before you start again)", synced_));
}

void Journal::dropAll(std::vector<JournalPosition> positions) {
  std::ranges::sort(positions, {}, &JournalPosition::segment);
  for (auto next = positions.begin(); next != positions.end();) {
    const auto first = next;
    next = std::find_if(first, positions.end(), [&](const JournalPosition& position) {
      return position.segment != first->segment;
    });
    dropIn(first->segment, {first, next});
  }
}

void Journal::dropIn(std::uint32_t segment, std::span<const JournalPosition> positions) {
  const std::filesystem::path path = segmentPath(segment);
  const FileDescriptor file(open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file && errno == ENOENT) return;
  struct stat info {};
  if (!file || fstat(file.get(), &info) != 0)
    throw failure("{}: cannot open: {}", path.string(), errnoText());
  const SegmentFile reader(path, segment);
  for (const JournalPosition& position : positions) {
    // The file was cut off before the end of this record, so nothing needs a mark.
    if (std::cmp_less(info.st_size, position.offset + position.length)) continue;
    if (!writeAt(file.get(), position.offset, markFor(reader, position)))
      throw failure("{}: cannot mark the damaged record at byte {}: {}", path.string(),
                    position.offset, errnoText());
  }
  if (fdatasync(file.get()) != 0)
    throw failure("{}: cannot sync the marks of dropped records: {}", path.string(), errnoText());
}

void Journal::fillMissing() {
  if (present_.empty()) return;
  for (std::uint32_t segment = 1; segment < present_.back(); ++segment) {
    const std::filesystem::path path = segmentPath(segment);
    const FileDescriptor file(open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
    if (!file) throw failure("{}: cannot create: {}", path.string(), errnoText());
  }
  syncFolder(directory_);
  present_ = segmentsIn(directory_);
}

void Journal::checkPresence() const {
  struct stat mine {};
  if (fstat(file_.get(), &mine) != 0)
    throw failure("{}: cannot stat: {}", segmentPath(end_.segment).string(), errnoText());
  for (const std::uint32_t segment : present_) {
    struct stat info {};
    const std::filesystem::path path = segmentPath(segment);
    const bool there = stat(path.c_str(), &info) == 0;
    if (there && (segment != end_.segment || info.st_ino == mine.st_ino)) continue;
    throw failure(
        "{}: was {} while this scheduler was using it: put it back, or start again to compute its "
        "results again",
        path.string(), there ? "replaced" : "removed");
  }
}

void Journal::openSegment() {
  const std::filesystem::path path = segmentPath(end_.segment);
  file_ = FileDescriptor(open(path.c_str(), O_RDWR | O_CLOEXEC | O_CREAT, 0600));
  if (!file_) throw failure("{}: cannot open: {}", path.string(), errnoText());
  if (std::ranges::find(present_, end_.segment) == present_.end()) present_.push_back(end_.segment);
}

/// Syncs the segments before the open one. A killed run may have left drop marks there unsynced,
/// which the next power cut could undo.
void Journal::syncOthers() const {
  for (const std::uint32_t segment : present_) {
    if (segment == end_.segment) continue;
    const std::filesystem::path path = segmentPath(segment);
    const FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (!file || fdatasync(file.get()) != 0)
      throw failure("{}: cannot sync: {}", path.string(), errnoText());
  }
}

void Journal::writePending() {
  PALPATE_ASSERT(pending_.size() <= end_.offset,
                 "pending bytes must be before the end of the segment");
  if (!writeAt(file_.get(), end_.offset - pending_.size(), pending_))
    throw failure(
        "{}: cannot write: {}: make room and start again; all acknowledged results are kept",
        segmentPath(end_.segment).string(), errnoText());
  pending_.clear();
}

}  // namespace palpate
