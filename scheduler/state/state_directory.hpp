#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/base/file_descriptor.hpp"
#include "common/keys/key_folder.hpp"

namespace palpate {

/// The folder of one build: segment-NNNNNN.dat, state.db, lock, endpoint and keys. The process that
/// holds this object is the only scheduler of the build. The lock is on the folder itself; the file
/// `lock` only names the holder.
class StateDirectory {
 public:
  /// Creates the folder if needed, and takes the lock. Folders above it are not created, since that
  /// would hide a mistyped name. New folders and files are readable by their owner alone. Throws on
  /// a network file system, where SQLite's WAL and flock do not work. Throws "in use by process N"
  /// if another scheduler holds the lock.
  explicit StateDirectory(const std::filesystem::path& path);

  /// Address of a scheduler, and the keys to connect with. Without keys, the scheduler requires
  /// none.
  struct Address {
    std::string endpoint;
    std::optional<KeyFolder> keys;
  };
  /// Writes the address into the folder atomically, so that `status` and `stop` find it. The
  /// constructor removed the address of an earlier run.
  void announce(const Address& address) const;
  /// Returns the address of the scheduler that holds `directory`; none if there is no such
  /// scheduler, or if it has not announced its address yet.
  static std::optional<Address> liveAddress(const std::filesystem::path& directory);
  /// Folder of the keys that only `palpate build` and its own workers use.
  std::filesystem::path keys() const { return path_ / "keys"; }
  /// Returns the process id of the scheduler that holds the lock of `directory`, or "unknown" if it
  /// cannot be read; none if the lock is free.
  static std::optional<std::string> holder(const std::filesystem::path& directory);

  /// Throws if the folder was removed or replaced by another.
  void checkPresence() const;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path database() const { return databaseIn(path_); }
  static std::filesystem::path databaseIn(const std::filesystem::path& directory) {
    return directory / "state.db";
  }

 private:
  std::filesystem::path path_;
  FileDescriptor lock_;  ///< descriptor of the folder
};

/// Returns the name of a network file system from its number (f_type of statfs); nullptr for a
/// local file system.
const char* networkFileSystem(long type);

}  // namespace palpate
