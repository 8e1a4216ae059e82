#include "common/base/whole_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <system_error>

#include "common/base/error.hpp"
#include "common/base/file_descriptor.hpp"
#include "common/base/program.hpp"

namespace palpate {
namespace {

void syncToDisk(const std::filesystem::path& path, int flags) {
  const FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | flags));
  if (file && fsync(file.get()) == 0) return;
  const std::string reason = errnoText();
  throw failure("{}: cannot be flushed to disk: {}", path.string(), reason);
}

Error unwritable(const std::filesystem::path& file, std::string_view what) {
  const std::string reason = errno == 0 ? "the system gives no reason" : errnoText();
  return failure(
      "{}: cannot write the {}: {}; check the folder, its permissions and the space left",
      file.string(), what, reason);
}

/// Opens and locks FILE.tmp, so that other processes wait. A file that a killed process has left is
/// reused. On file systems without locks (some network file systems), two processes may write the
/// file at the same time.
FileDescriptor takeAside(const std::filesystem::path& aside, std::string_view what, mode_t mode) {
  for (;;) {
    FileDescriptor taken(open(aside.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, mode));
    struct stat held {};
    struct stat there {};
    if (!taken || fstat(taken.get(), &held) != 0) throw unwritable(aside, what);
    while (flock(taken.get(), LOCK_EX) != 0 && errno == EINTR)
      if (interrupted())
        throw Error(ExitCode::interrupted,
                    fmt::format("interrupted while waiting for another process that writes {}",
                                aside.string()));
    // Try again if the locked file is no longer at the path: the process that held the lock before
    // has renamed or removed it.
    if (stat(aside.c_str(), &there) != 0 || held.st_dev != there.st_dev ||
        held.st_ino != there.st_ino)
      continue;
    if ((held.st_mode & 077 & ~mode) != 0 && fchmod(taken.get(), mode) != 0)
      throw unwritable(aside, what);
    return taken;
  }
}

void replace(const std::filesystem::path& named, std::string_view what, mode_t mode,
             const std::function<void(const std::filesystem::path& aside)>& write) {
  const std::filesystem::path file = linkTarget(named);
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored) && !std::filesystem::is_regular_file(file, ignored))
    throw failure("{}: is a {}, which cannot be overwritten; give another name", named.string(),
                  std::filesystem::is_directory(file, ignored) ? "directory" : "device or pipe");
  std::filesystem::path aside = file;
  aside += ".tmp";
  FileDescriptor held = takeAside(aside, what, mode);
  try {
    write(aside);
    syncToDisk(aside, 0);
    std::filesystem::rename(aside, file);
  } catch (const std::filesystem::filesystem_error& error) {
    std::filesystem::remove(aside, ignored);
    throw failure("{}: {}", file.string(), error.code().message());
  } catch (...) {
    std::filesystem::remove(aside, ignored);
    throw;
  }
  held = {};
  // The rename is on disk only after the folder is synced.
  syncFolder(file.parent_path());
}

}  // namespace

std::filesystem::path linkTarget(std::filesystem::path file) {
  constexpr int most_links = 40;  // the kernel's limit
  std::error_code none;
  for (int links = 0; std::filesystem::is_symlink(file, none); ++links) {
    if (links == most_links) throw failure("{}: these symbolic links form a loop", file.string());
    file = file.parent_path() / std::filesystem::read_symlink(file);
  }
  return file;
}

std::string readText(const std::filesystem::path& file, std::string_view what) {
  std::error_code error;
  // Check this first, because a directory can be opened and fails only at the first read.
  if (std::filesystem::is_directory(file, error))
    throw badInput("{} {} is a directory", what, file.string());
  std::ifstream in(file, std::ios::binary);
  if (!in)
    throw badInput("{} {} cannot be opened: {}", what, file.string(),
                   std::generic_category().message(errno));
  std::string text;
  for (std::array<char, 1 << 16> chunk; in.read(chunk.data(), chunk.size()), in.gcount() > 0;)
    text.append(chunk.data(), static_cast<std::size_t>(in.gcount()));
  if (in.bad()) throw failure("{} {} cannot be read to its end", what, file.string());
  return text;
}

void replaceFile(const std::filesystem::path& file,
                 const std::function<void(const std::filesystem::path& aside)>& write) {
  replace(file, "file", 0666, write);
}

void replaceFile(const std::filesystem::path& file, std::string_view bytes, std::string_view what) {
  replaceFile(
      file, [&] { return std::string(bytes); }, what, 0666);
}

void replaceFile(const std::filesystem::path& file, const std::function<std::string()>& bytes,
                 std::string_view what, mode_t mode) {
  replace(file, what, mode, [&](const std::filesystem::path& aside) {
    const std::string all = bytes();
    errno = 0;
    std::ofstream out(aside, std::ios::binary);
    out << all;
    // Close before the check, because close() writes the last bytes.
    out.close();
    if (!out) throw unwritable(file, what);
  });
}

bool writeAt(int descriptor, std::uint64_t offset, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n == 0) errno = ENOSPC;
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
  return true;
}

void syncFolder(const std::filesystem::path& folder) {
  syncToDisk(folder.empty() ? "." : folder, O_DIRECTORY);
}

void refuseUnwritable(const std::filesystem::path& file, const char* option) {
  std::error_code ignored;  // whatever cannot be looked at is no directory
  if (std::filesystem::is_directory(file, ignored))
    throw failure("{} {}: is a directory; add the name of a file", option, file.string());
  const std::filesystem::path target = linkTarget(file);
  const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : ".";
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw failure("{}: cannot write into {}: {}; give another {}", file.string(), folder.string(),
                  errnoText(), option);
}

void refuseInput(const std::filesystem::path& file, const char* option,
                 std::span<const std::filesystem::path> inputs) {
  for (const std::filesystem::path& input : inputs) {
    std::error_code none;  // ignored: if a file is missing, the two are not equivalent
    if (std::filesystem::equivalent(file, input, none))
      throw badInput("{} {}: is the input {}, which would be overwritten; name another file",
                     option, file.string(), input.string());
  }
}

}  // namespace palpate
