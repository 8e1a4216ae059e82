#pragma once

#include <string_view>

#include "common/dataset/hdf5_handle.hpp"

namespace palpate::hdf5 {

/// A file that HDF5 makes in memory, with its core driver: what the caller then writes to disk, the
/// caller can also fail to write. (HDF5's POSIX driver reports a full disk, after which 1.10.8
/// cannot close the file any more and the process dies in its exit handler.) The whole file is in
/// memory, once, until this object ends: compressed fields of some GB at most.
class FileImage {
 public:
  FileImage() = default;
  FileImage(const FileImage&) = delete;
  FileImage& operator=(const FileImage&) = delete;
  ~FileImage();

  /// Makes H5Fcreate with these file access properties create the file here. One file per image;
  /// it must be closed before the image ends.
  void useIn(hid_t file_access);
  /// Closes `file`, which was created here, and gives its bytes, valid as long as this object.
  /// Error that begins with `name` when HDF5 cannot close it.
  std::string_view finish(Handle& file, std::string_view name);

 private:
  static void* resize(void* bytes, std::size_t size, H5FD_file_image_op_t, void* image);
  static herr_t keep(void* bytes, H5FD_file_image_op_t, void* image);

  void* bytes_ = nullptr;
  std::size_t size_ = 0;  ///< of the memory, of which the file is the beginning
};

}  // namespace palpate::hdf5
