#pragma once

#include <sys/types.h>

#include <cstddef>

/// The real system calls that change files. They bypass the simulated disk.
namespace palpate::simulation::calls {

int open(const char* path, int flags, mode_t mode);
int close(int file);
/// Calls write() if `offset` is negative.
ssize_t write(int file, const void* bytes, std::size_t count, off_t offset);
int truncate(int file, off_t size);
int sync(int file);
int rename(const char* from, const char* to);
int unlink(const char* path);
int makeDirectory(const char* path, mode_t mode);

}  // namespace palpate::simulation::calls
