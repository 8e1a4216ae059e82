#include "scheduler/state/state_directory.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/vfs.h>

#include <fstream>
#include <map>
#include <thread>

#include "common/base/error.hpp"
#include "common/base/whole_file.hpp"

namespace palpate {
namespace {

void refuseNetworkFileSystem(const std::filesystem::path& path) {
  struct statfs info {};
  if (statfs(path.c_str(), &info) != 0)
    throw failure("{}: cannot determine the file system: {}", path.string(), errnoText());
  if (const char* name = networkFileSystem(info.f_type))
    throw badInput(
        "{}: is on {}, which is not safe for the state database: choose a --state directory on a "
        "local disk (the dataset itself may be anywhere)",
        path.string(), name);
}

std::string holderOf(const std::filesystem::path& directory) {
  std::ifstream file(directory / "lock");
  std::string pid;
  return std::getline(file, pid) && !pid.empty() ? pid : "unknown";
}

/// Locks the folder itself, so that removing files in it cannot free the lock.
FileDescriptor takeLock(const std::filesystem::path& directory) {
  FileDescriptor lock(open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!lock) throw failure("{}: cannot open: {}", directory.string(), errnoText());
  // Try several times: holder() in another process takes the lock for a moment to test it.
  for (int tries = 0; flock(lock.get(), LOCK_EX | LOCK_NB) != 0; ++tries) {
    if (errno == EWOULDBLOCK && tries < 10) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      continue;
    }
    if (errno != EWOULDBLOCK) throw failure("{}: cannot lock: {}", directory.string(), errnoText());
    throw failure(
        "{} is in use by process {}, another scheduler: wait for it, stop it, "
        "or use another --state directory",
        directory.string(), holderOf(directory));
  }
  return lock;
}

/// Only the owner of the state can read the file.
void writeText(const std::filesystem::path& file, const std::string& text) {
  replaceFile(
      file, [&] { return text; }, "file", 0600);
}

constexpr const char* endpoint_file = "endpoint";

std::optional<StateDirectory::Address> addressIn(const std::filesystem::path& path) {
  std::ifstream file(path);
  StateDirectory::Address address;
  if (!std::getline(file, address.endpoint)) return std::nullopt;
  if (std::string keys; std::getline(file, keys)) address.keys = KeyFolder(keys);
  return address;
}

}  // namespace

const char* networkFileSystem(long type) {
  static const std::map<unsigned long, const char*> names = {
      {0x6969, "NFS"},        {0x517B, "SMB"},      {0xFF534D42, "SMB"}, {0xFE534D42, "SMB"},
      {0x0BD00BD0, "Lustre"}, {0x47504653, "GPFS"}, {0x5346414F, "AFS"}, {0x00C36400, "Ceph"},
      {0x19830326, "BeeGFS"}, {0x65735546, "FUSE"}, {0x01021997, "9p"}};
  // A file system's number has 32 bits, but some systems sign-extend it.
  const auto found = names.find(static_cast<unsigned long>(type) & 0xffffffff);
  return found == names.end() ? nullptr : found->second;
}

StateDirectory::StateDirectory(const std::filesystem::path& path) : path_(path) {
  std::error_code error;
  const std::filesystem::path above = (path / ".").lexically_normal().parent_path().parent_path();
  const bool made = std::filesystem::create_directory(path, error);
  if (error == std::errc::no_such_file_or_directory)
    throw failure(
        "{}: cannot create this state directory, because there is no folder {}: create the folder "
        "first, or choose another --state",
        path.string(), above.string());
  if (error)
    throw failure("{}: cannot create this state directory: {}", path.string(), error.message());
  if (made) std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  refuseNetworkFileSystem(path);
  lock_ = takeLock(path);
  // Remove the address of an earlier scheduler, which no longer listens there, before the syncs
  // below: commands would ask it and wait in vain.
  std::filesystem::remove(path / endpoint_file, error);
  if (error)
    throw failure("{}: cannot remove: {}", (path / endpoint_file).string(), error.message());
  // Sync the folder above a new folder: a power cut could otherwise remove the new folder with
  // everything in it. A folder with tables is not new. Its results may be acknowledged already, so
  // a sync would come too late.
  if (!std::filesystem::exists(database())) syncFolder(above);
  writeText(path / "lock", std::to_string(getpid()) + '\n');
}

void StateDirectory::announce(const Address& address) const {
  std::string text = address.endpoint + '\n';
  if (address.keys) text += std::filesystem::absolute(address.keys->path()).string() + '\n';
  writeText(path_ / endpoint_file, text);
}

void StateDirectory::checkPresence() const {
  struct stat held {};
  struct stat there {};
  if (fstat(lock_.get(), &held) != 0)
    throw failure("{}: cannot stat: {}", path_.string(), errnoText());
  if (stat(path_.c_str(), &there) == 0 && there.st_ino == held.st_ino &&
      there.st_dev == held.st_dev)
    return;
  throw failure(
      "{}: was removed or replaced while this scheduler was using it, so no more results can be "
      "stored: put it back and start again, or start with another --state",
      path_.string());
}

std::optional<std::string> StateDirectory::holder(const std::filesystem::path& directory) {
  const FileDescriptor lock(open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!lock || flock(lock.get(), LOCK_SH | LOCK_NB) == 0) return std::nullopt;
  return holderOf(directory);
}

std::optional<StateDirectory::Address> StateDirectory::liveAddress(
    const std::filesystem::path& directory) {
  return holder(directory) ? addressIn(directory / endpoint_file) : std::nullopt;
}

}  // namespace palpate
