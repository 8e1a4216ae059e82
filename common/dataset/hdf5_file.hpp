#pragma once

#include <hdf5.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace palpate::hdf5 {

/// A new file on disk for HDF5 to write into (a driver of its "virtual file layer").
///
/// What cannot be written any more is not told to HDF5 (1.10.8), which could not close the file
/// then, and dies in the exit handler of the process: it is kept in memory, and error() says what
/// happened. Nothing more than the cache of HDF5 comes after that.
///
/// What HDF5 leaves unused between its structures is zero: equal calls, equal bytes.
class NewFile {
 public:
  /// Empty, replacing what is there. Error when it cannot be made.
  explicit NewFile(const std::filesystem::path& path);
  NewFile(const NewFile&) = delete;  // HDF5 keeps its place
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile();

  /// Makes H5Fcreate with these file access properties create the file here.
  void use(hid_t file_access);
  /// Why it could not be written; empty as long as it could.
  const std::string& error() const { return error_; }
  /// After HDF5 has closed its file: all of it is handed to the system.
  void close();

 private:
  friend struct Driver;
  void write(std::uint64_t at, const char* bytes, std::size_t count);
  void read(std::uint64_t at, char* bytes, std::size_t count);
  void writePending();
  void cutOff(std::uint64_t size);
  void fail();

  int file_ = -1;
  /// Bytes that follow each other and are not in the file yet: HDF5 writes in small pieces.
  std::string pending_;
  std::uint64_t pending_at_ = 0;
  std::uint64_t size_ = 0;
  std::string error_;
  std::vector<std::pair<std::uint64_t, std::string>> unwritten_;  ///< since then, in order
};

}  // namespace palpate::hdf5
