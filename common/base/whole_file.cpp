#include "common/base/whole_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <system_error>

#include "common/base/error.hpp"

namespace palpate {
namespace {

void syncToDisk(const std::filesystem::path& path, int flags) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | flags);
  const bool synced = descriptor >= 0 && fsync(descriptor) == 0;
  // close() may change it.
  const int reason = errno;
  if (descriptor >= 0) close(descriptor);
  if (!synced)
    throw failure("{}: cannot be flushed to disk: {}", path.string(), std::strerror(reason));
}

}  // namespace

std::string readText(const std::filesystem::path& file, std::string_view what) {
  std::error_code error;
  // A directory opens like a file and fails at the first read.
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
  std::error_code ignored;
  std::filesystem::path aside = file;
  aside += ".tmp";
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
  // A rename is on disk only when its folder is.
  syncFolder(file.parent_path());
}

void replaceFile(const std::filesystem::path& file, std::string_view bytes, std::string_view what) {
  replaceFile(file, [&](const std::filesystem::path& aside) {
    errno = 0;
    std::ofstream out(aside, std::ios::binary);
    out << bytes;
    // The last bytes are written here: only now is it known whether the disk took all.
    out.close();
    if (!out)
      throw failure(
          "{}: cannot write the {}: {}; check the folder, its permissions and the space left",
          file.string(), what, errno == 0 ? "the system does not say why" : errnoText());
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
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw failure("{}: nothing can be written into {}: {}: give another {}", file.string(),
                  folder.string(), errnoText(), option);
}

void refuseInput(const std::filesystem::path& file, const char* option,
                 std::span<const std::filesystem::path> inputs) {
  for (const std::filesystem::path& input : inputs) {
    std::error_code none;  // what does not exist is no other file
    if (std::filesystem::equivalent(file, input, none))
      throw badInput("{} {}: is {}, which is read and would be replaced; name another file", option,
                     file.string(), input.string());
  }
}

}  // namespace palpate
