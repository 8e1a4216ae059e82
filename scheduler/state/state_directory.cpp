#include "scheduler/state/state_directory.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/vfs.h>

#include <array>
#include <fstream>
#include <map>
#include <thread>

#include "common/base/error.hpp"

namespace palpate {
namespace {

void refuseNetworkFileSystem(const std::filesystem::path& path) {
  struct statfs info {};
  if (statfs(path.c_str(), &info) != 0)
    throw failure("{}: cannot look at the file system: {}", path.string(), errnoText());
  if (const char* name = networkFileSystem(info.f_type))
    throw badInput(
        "{}: is on {}, where the state database would not survive: "
        "give --state a directory on a local disk (the dataset itself may lie anywhere)",
        path.string(), name);
}

FileDescriptor takeLock(const std::filesystem::path& file) {
  FileDescriptor lock(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (!lock) throw failure("{}: cannot open: {}", file.string(), errnoText());
  // liveEndpoint() holds the lock for a moment to look at it.
  for (int tries = 0; flock(lock.get(), LOCK_EX | LOCK_NB) != 0; ++tries) {
    if (errno == EWOULDBLOCK && tries < 10) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      continue;
    }
    if (errno != EWOULDBLOCK) throw failure("{}: cannot lock: {}", file.string(), errnoText());
    std::array<char, 32> text{};
    const ssize_t n = pread(lock.get(), text.data(), text.size() - 1, 0);
    throw failure(
        "{} is in use by process {}, another scheduler: wait for it, stop it, "
        "or use another --state directory",
        file.parent_path().string(), n > 0 ? std::string(text.data()) : "unknown");
  }
  const std::string pid = std::to_string(getpid());
  if (ftruncate(lock.get(), 0) != 0 ||
      pwrite(lock.get(), pid.data(), pid.size(), 0) != static_cast<ssize_t>(pid.size()))
    throw failure("{}: cannot write: {}", file.string(), errnoText());
  return lock;
}

}  // namespace

const char* networkFileSystem(long type) {
  static const std::map<unsigned long, const char*> names = {
      {0x6969, "NFS"},     {0x517B, "SMB"},        {0xFF534D42, "SMB"},
      {0xFE534D42, "SMB"}, {0x0BD00BD0, "Lustre"}, {0x47504653, "GPFS"},
      {0x5346414F, "AFS"}, {0x00C36400, "Ceph"},   {0x19830326, "BeeGFS"}};
  // The number is an unsigned one of 32 bits, which some systems extend with its sign.
  const auto found = names.find(static_cast<unsigned long>(type) & 0xffffffff);
  return found == names.end() ? nullptr : found->second;
}

StateDirectory::StateDirectory(const std::filesystem::path& path) : path_(path) {
  std::error_code error;
  std::filesystem::create_directory(path, error);
  if (error == std::errc::no_such_file_or_directory)
    throw failure(
        "{}: cannot make this state directory: there is no folder {} to make it in: "
        "make that first, or give another --state",
        path.string(), (path / ".").lexically_normal().parent_path().parent_path().string());
  if (error)
    throw failure("{}: cannot make this state directory: {}", path.string(), error.message());
  refuseNetworkFileSystem(path);
  lock_ = takeLock(path / "lock");
  std::filesystem::remove(path / "endpoint", error);
  if (error) throw failure("{}: cannot remove: {}", (path / "endpoint").string(), error.message());
}

void StateDirectory::announce(const std::string& endpoint) const {
  const std::filesystem::path aside = path_ / "endpoint.tmp";
  std::ofstream file(aside);
  file << endpoint << '\n';
  file.close();
  if (!file) throw failure("{}: cannot write", aside.string());
  std::filesystem::rename(aside, path_ / "endpoint");
}

std::optional<std::string> StateDirectory::liveEndpoint(const std::filesystem::path& directory) {
  const FileDescriptor lock(open((directory / "lock").c_str(), O_RDONLY | O_CLOEXEC));
  if (!lock || flock(lock.get(), LOCK_SH | LOCK_NB) == 0) return std::nullopt;
  std::ifstream file(directory / "endpoint");
  std::string endpoint;
  if (!std::getline(file, endpoint)) return std::nullopt;
  return endpoint;
}

}  // namespace palpate
