#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/base/file_descriptor.hpp"

namespace palpate {

/// The folder that holds one build: segment-NNNNNN.dat, state.db, lock, endpoint and keys. Holding
/// this object means being its only scheduler: the lock is on the folder itself, and the file
/// `lock` only says who holds it.
class StateDirectory {
 public:
  /// Makes the folder when it is not there (but not those above it, which would hide a mistyped
  /// name), refuses network file systems (SQLite's WAL and flock do not work on them), and takes
  /// the lock. What it makes is for the owner alone. Error "in use by process N" when another
  /// scheduler holds it.
  explicit StateDirectory(const std::filesystem::path& path);

  /// Where a scheduler listens, and the folder of the keys it lives by; without one it asks for
  /// none.
  struct Address {
    std::string endpoint;
    std::optional<std::filesystem::path> keys;
  };
  /// Writes it into the folder, all at once, so that `status` and `stop` find it there. What an
  /// earlier run wrote is gone since construction.
  void announce(const Address& address) const;
  /// What the scheduler now holding `directory` announced; nothing when none holds it, or it has
  /// announced nothing yet.
  static std::optional<Address> liveAddress(const std::filesystem::path& directory);
  /// Where a build keeps the keys that it and its workers alone use.
  std::filesystem::path keys() const { return path_ / "keys"; }
  /// The process number of whoever holds the lock of `directory`, "unknown" when it cannot be read;
  /// nothing when nobody does.
  static std::optional<std::string> holder(const std::filesystem::path& directory);

  /// Error when the folder was removed or replaced by another.
  void checkPresence() const;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path database() const { return databaseIn(path_); }
  static std::filesystem::path databaseIn(const std::filesystem::path& directory) {
    return directory / "state.db";
  }

 private:
  std::filesystem::path path_;
  FileDescriptor lock_;  ///< the folder
};

/// The name of a network file system by its statfs number, nullptr for a local one.
const char* networkFileSystem(long type);

}  // namespace palpate
