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

/// What a disk can be told to do at the next operation that it fits.
enum class DiskFault : std::uint8_t { write_error, short_write, sync_error, rename_error, full };

/// A disk that forgets what was not synced. The files are real ones below a folder (in memory,
/// where possible); every system call that changes them, whoever makes it in this process (we,
/// SQLite, HDF5, the standard library), comes through here, because this program defines those
/// functions itself (disk_calls.cpp).
///
/// What a power cut leaves: of a file what was synced, and of what was written since, any 512-byte
/// sectors; of a folder its names at the last sync, and any number of the changes since, in order.
/// A sync that fails loses what it should have written, and a later one that succeeds does not
/// bring it back. One per process at a time.
class Disk {
 public:
  /// Everything below `root`.
  Disk(const std::filesystem::path& root, std::uint64_t seed);
  ~Disk();
  Disk(const Disk&) = delete;
  Disk& operator=(const Disk&) = delete;
  /// Null when there is none.
  static Disk* mounted();

  // Faults.
  /// The process that uses it is killed at the n-th change from now: half a write, and no change
  /// any more.
  void killAfter(int changes) { changes_left_ = changes; }
  void doNotKill() { changes_left_ = -1; }
  /// Killed: every change fails from now on, until revive(). The process must be unwound.
  bool dead() const { return dead_; }
  void die() { dead_ = true; }
  void revive() { dead_ = false; }
  void arm(DiskFault fault) { armed_.insert(fault); }
  void disarm() { armed_.clear(); }
  void setFull(bool full) { full_ = full; }
  /// How often each fault was felt.
  const std::map<DiskFault, std::uint64_t>& felt() const { return felt_; }
  /// A fault that ends a process was felt since the last call.
  bool takeHurt() { return std::exchange(hurt_, false); }
  /// Nobody may have a file open. Everything that is there afterwards is on disk.
  void cutPower();
  /// What others do before the process that calls this reads the names in a folder or opens a
  /// segment of the journal for the n-th time from now. Once.
  void beforeRead(int nth, std::function<void()> then) {
    reads_left_ = nth;
    before_read_ = std::move(then);
  }
  void reads();
  /// Flips a bit of what is on disk and of what readers see.
  void flip(const std::filesystem::path& file, std::uint64_t byte, int bit);

  // The system calls. errno as theirs.
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
    bool streamed = false;  ///< the C library's streams write it, which nobody sees
    std::string durable;    ///< what was synced
    std::vector<std::pair<std::size_t, std::size_t>> dirty;  ///< written since: begin, end
    std::string orphaned;                                    ///< content when its name went
    std::string path;                                        ///< now; empty: none
  };
  using NodePointer = std::shared_ptr<Node>;
  using Names = std::map<std::string, NodePointer>;  ///< of one folder

  bool tracks(const std::string& path) const;
  static std::string folderOf(const std::string& path);
  NodePointer nodeOf(const std::string& path) const;
  void renamed(const std::string& folder);
  /// Room for one change: false with errno when the process is dead, or dies.
  bool change();
  bool strikes(DiskFault fault, int error);
  void hurts(DiskFault fault, int error);
  std::string after(const Node& node);
  void rebuild(const std::string& folder, std::map<std::string, std::string>& files,
               std::vector<std::string>& folders);
  void track();

  std::string root_;
  Random random_;
  std::map<std::string, Names> names_;                 ///< by folder, now
  std::map<std::string, std::vector<Names>> history_;  ///< since the last sync of the folder
  std::map<int, NodePointer> open_;
  std::set<DiskFault> armed_;
  int changes_left_ = -1;  ///< -1: for ever
  int reads_left_ = 0;
  std::function<void()> before_read_;
  bool dead_ = false, full_ = false, hurt_ = false;
  std::map<DiskFault, std::uint64_t> felt_;
};

}  // namespace palpate::simulation
