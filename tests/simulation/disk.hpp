#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/simulation/random.hpp"

namespace palpate::simulation {

/// Faults of a disk. Each strikes at the next operation of its kind.
enum class DiskFault : std::uint8_t { write_error, short_write, sync_error, rename_error, full };

/// A disk that forgets unsynced data. The files are real files below a folder (in memory, if
/// possible). Every system call of this process that changes them (by the project, SQLite, HDF5 or
/// the standard library) comes through here, because this program defines those functions itself
/// (disk_calls.cpp).
///
/// A power cut keeps the synced contents of a file. Each 512-byte sector that was written since
/// then survives with a probability of one half. Of a folder, the names at the last sync survive,
/// with a random number of the changes since then, the earliest first. A failed sync loses the data
/// that it should have written, and a later successful sync does not restore them. A process can
/// have only one disk at a time.
class Disk {
 public:
  /// Takes over everything below `root`.
  Disk(const std::filesystem::path& root, std::uint64_t seed);
  ~Disk();
  Disk(const Disk&) = delete;
  Disk& operator=(const Disk&) = delete;
  /// Returns the disk of this process; null if there is none.
  static Disk* mounted();

  // Faults.
  /// Kills the process that uses the disk at change number `changes` from now. If this change is a
  /// write, a random part of it is done. Later changes are not done.
  void killAfter(int changes) { changes_left_ = changes; }
  void doNotKill() { changes_left_ = -1; }
  /// True after a kill: every change fails until revive(). The process must be unwound.
  bool dead() const { return dead_; }
  void die() { dead_ = true; }
  void revive() { dead_ = false; }
  void arm(DiskFault fault) { armed_.insert(fault); }
  void disarm() { armed_.clear(); }
  void setFull(bool full) { full_ = full; }
  /// How often each fault took effect.
  const std::map<DiskFault, std::uint64_t>& felt() const { return felt_; }
  /// Whether a fault that ends a process took effect since the last call.
  bool takeHurt() { return std::exchange(hurt_, false); }
  /// Cuts the power. No file may be open. Everything that is left then counts as synced.
  void cutPower();
  /// Simulates an action of another process: runs `then` once, before the n-th time from now that
  /// the calling process lists a folder or opens a segment of the journal.
  void beforeRead(int nth, std::function<void()> then) {
    reads_left_ = nth;
    before_read_ = std::move(then);
  }
  void reads();
  /// Flips a bit both on disk and for readers.
  void flip(const std::filesystem::path& file, std::uint64_t byte, int bit);

  // The system calls. They set errno as usual.
  int open(const char* path, int flags, mode_t mode);
  int close(int file);
  ssize_t write(int file, const void* bytes, std::size_t count, off_t offset);
  int truncate(int file, off_t size);
  int sync(int file);
  int rename(const char* from, const char* to);
  int unlink(const char* path);
  int makeDirectory(const char* path, mode_t mode);

 private:
  struct Node {
    bool folder = false;
    bool streamed = false;  ///< written by streams of the C library, which bypass this class
    std::string durable;    ///< the synced contents
    std::vector<std::pair<std::size_t, std::size_t>> dirty;  ///< ranges written since: begin, end
    std::string orphaned;                                    ///< contents when its name was removed
    std::string path;                                        ///< current path; empty if none
  };
  using NodePointer = std::shared_ptr<Node>;
  using Names = std::map<std::string, NodePointer>;  ///< in one folder

  bool tracks(const std::string& path) const;
  static std::string folderOf(const std::string& path);
  NodePointer nodeOf(const std::string& path) const;
  void renamed(const std::string& folder);
  /// Counts one change. Returns false, with errno set, if the process is dead or dies now.
  bool change();
  bool strikes(DiskFault fault, int error);
  void hurts(DiskFault fault, int error);
  std::string after(const Node& node);
  void rebuild(const std::string& folder, std::map<std::string, std::string>& files,
               std::vector<std::string>& folders);
  void track();

  std::string root_;
  Random random_;
  std::map<std::string, Names> names_;                 ///< current names, by folder
  std::map<std::string, std::vector<Names>> history_;  ///< names since the last sync of the folder
  std::map<int, NodePointer> open_;
  std::set<DiskFault> armed_;
  int changes_left_ = -1;  ///< -1: no limit
  int reads_left_ = 0;
  std::function<void()> before_read_;
  bool dead_ = false, full_ = false, hurt_ = false;
  std::map<DiskFault, std::uint64_t> felt_;
};

}  // namespace palpate::simulation
