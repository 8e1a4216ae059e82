#pragma once

#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

namespace palpate::test {

/// Opens an HDF5 file for writing in a process that exits without closing it.
inline void leaveOpenForWriting(const std::filesystem::path& path) {
  const pid_t child = fork();
  if (child == 0) {
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    _exit(file >= 0 && H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0 ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_EQ(status, 0) << path << " could not be opened for writing";
}

}  // namespace palpate::test
