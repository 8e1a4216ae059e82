#pragma once

#include "common/dataset/hdf5_handle.hpp"

namespace palpate::hdf5 {

/// How HDF5 reaches the file of a Writer. Its own POSIX driver reports a full disk, after which
/// HDF5 1.10.8 cannot close the file any more and the process dies in its exit handler. This driver
/// tells HDF5 that all went well, keeps in memory what could not be written, so that the library
/// can tidy up, and remembers the errno of the first failure for us.
class WriteDriver {
 public:
  WriteDriver();
  WriteDriver(const WriteDriver&) = delete;
  WriteDriver& operator=(const WriteDriver&) = delete;

  /// Makes H5Fcreate with these file access properties go through this driver. One file per driver.
  void useIn(hid_t file_access);
  /// errno of the first call that failed; 0 while there is none.
  int error() const { return error_; }

 private:
  int error_ = 0;
  Handle driver_;
};

}  // namespace palpate::hdf5
