#include "scheduler/state/journal.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <zlib.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <fstream>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"

namespace palpate {
namespace {

/// What a record begins with; its header and its payload follow.
struct Head {
  std::array<char, 4> magic = {'P', 'J', 'R', '1'};
  std::uint32_t header_bytes = 0, payload_bytes = 0;
  std::uint32_t crc = 0;
};
static_assert(sizeof(Head) == 16, "as docs/state.md says it");

/// Over the two lengths in the head and what follows it.
std::uint32_t crcOf(const std::string& record) {
  const auto* bytes = reinterpret_cast<const Bytef*>(record.data());
  const uLong of_lengths = crc32_z(0, bytes + offsetof(Head, header_bytes), 8);
  return static_cast<std::uint32_t>(
      crc32_z(of_lengths, bytes + sizeof(Head), record.size() - sizeof(Head)));
}

/// Reads up to `length` bytes at `offset`; fewer at the end of the file.
std::string readAt(const std::filesystem::path& path, std::uint64_t offset, std::uint64_t length) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw failure("{}: cannot open: {}", path.string(), errnoText());
  std::string bytes(length, '\0');
  file.seekg(static_cast<std::streamoff>(offset));
  file.read(bytes.data(), static_cast<std::streamsize>(length));
  if (file.bad()) throw failure("{}: cannot read: {}", path.string(), errnoText());
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

/// So that files made in it survive a crash.
void syncDirectory(const std::filesystem::path& directory) {
  const FileDescriptor handle(open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!handle || fsync(handle.get()) != 0)
    throw failure("{}: cannot sync: {}", directory.string(), errnoText());
}

}  // namespace

Journal::Journal(std::filesystem::path directory, JournalEnd committed, std::uint64_t segment_bytes)
    : directory_(std::move(directory)), segment_bytes_(segment_bytes), end_(committed) {
  // A segment without a committed record may not have been made before the crash.
  openSegment(committed.offset == 0);
  struct stat info {};
  if (fstat(file_.get(), &info) != 0)
    throw failure("{}: cannot look at: {}", segmentPath(end_.segment).string(), errnoText());
  if (static_cast<std::uint64_t>(info.st_size) < committed.offset)
    throw failure(
        "{}: has {} bytes, but {} were committed: the state directory is damaged; "
        "restore it from a copy, or remove it to compute everything again",
        segmentPath(end_.segment).string(), info.st_size, committed.offset);
  // What lies behind was never acknowledged, and may be half a record.
  if (ftruncate(file_.get(), static_cast<off_t>(committed.offset)) != 0)
    throw failure("{}: cannot truncate: {}", segmentPath(end_.segment).string(), errnoText());
  for (std::uint32_t later = end_.segment + 1; std::filesystem::remove(segmentPath(later));
       ++later) {
  }
  syncDirectory(directory_);
}

JournalPosition Journal::append(std::string_view header, std::string_view payload) {
  if (end_.offset >= segment_bytes_) {
    sync();
    // The full one is synced: later syncs reach only the segment that is open.
    ++end_.segment;
    end_.offset = 0;
    openSegment(true);
    syncDirectory(directory_);
  }
  PALPATE_ASSERT(std::max(header.size(), payload.size()) <= UINT32_MAX,
                 "a message and its payload are far below 4 GiB (max_payload_bytes)");
  Head head{.header_bytes = static_cast<std::uint32_t>(header.size()),
            .payload_bytes = static_cast<std::uint32_t>(payload.size())};
  std::string record(reinterpret_cast<const char*>(&head), sizeof head);
  record += header;
  record += payload;
  head.crc = crcOf(record);
  std::memcpy(record.data(), &head, sizeof head);
  writeAll(record);
  const JournalPosition position{end_.segment, end_.offset, record.size()};
  end_.offset += record.size();
  return position;
}

void Journal::sync() {
  // Never tried again: after a failed sync the kernel may take the lost pages for written.
  if (fdatasync(file_.get()) != 0)
    throw failure(
        "{}: fdatasync: {}: the disk does not keep what is written; "
        "nothing since the last acknowledgement counts",
        segmentPath(end_.segment).string(), errnoText());
}

JournalRecord Journal::read(const JournalPosition& position) const {
  const std::filesystem::path path = segmentPath(position.segment);
  const auto damaged = [&](const char* what) {
    return failure(
        "{}: record at byte {} is damaged ({}): restore the state directory from a copy, "
        "or remove it to compute everything again",
        path.string(), position.offset, what);
  };
  const std::string bytes = readAt(path, position.offset, position.length);
  // The position is that of the tables, so lengths that differ are damage on either side.
  Head head;
  if (bytes.size() != position.length || bytes.size() < sizeof head) throw damaged("cut off");
  std::memcpy(&head, bytes.data(), sizeof head);
  if (head.magic != Head{}.magic) throw damaged("no record begins here");
  if (sizeof head + head.header_bytes + head.payload_bytes != position.length)
    throw damaged("wrong length");
  if (head.crc != crcOf(bytes)) throw damaged("wrong checksum");
  return {bytes.substr(sizeof head, head.header_bytes),
          bytes.substr(sizeof head + head.header_bytes)};
}

std::filesystem::path Journal::segmentPath(std::uint32_t segment) const {
  return directory_ / fmt::format("segment-{:06}.dat", segment);
}

void Journal::openSegment(bool create) {
  const std::filesystem::path path = segmentPath(end_.segment);
  file_ = FileDescriptor(open(path.c_str(), O_RDWR | O_CLOEXEC | (create ? O_CREAT : 0), 0644));
  if (!file_ && errno == ENOENT)
    throw failure(
        "{}: is missing: the state directory is damaged; restore it from a copy, "
        "or remove it to compute everything again",
        path.string());
  if (!file_) throw failure("{}: cannot open: {}", path.string(), errnoText());
}

void Journal::writeAll(std::string_view bytes) {
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t n = pwrite(file_.get(), bytes.data() + written, bytes.size() - written,
                             static_cast<off_t>(end_.offset + written));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0)
      throw failure(
          "{}: cannot write: {}: make room and start again; everything acknowledged is kept",
          segmentPath(end_.segment).string(), n < 0 ? errnoText() : "nothing was written");
    written += static_cast<std::size_t>(n);
  }
}

}  // namespace palpate
