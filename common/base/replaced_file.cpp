#include "common/base/replaced_file.hpp"

#include <fcntl.h>
#include <unistd.h>

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
  const std::filesystem::path folder = file.parent_path();
  syncToDisk(folder.empty() ? "." : folder, O_DIRECTORY);
}

void refuseUnwritable(const std::filesystem::path& file, const char* option) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw failure("{}: nothing can be written into {}: {}: give another {}", file.string(),
                  folder.string(), errnoText(), option);
}

}  // namespace palpate
