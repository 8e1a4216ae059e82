#include "tests/simulation/disk_calls.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <ctime>

#include "tests/simulation/disk.hpp"

namespace palpate::simulation::calls {

int open(const char* path, int flags, mode_t mode) {
  return static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}
int close(int file) { return static_cast<int>(syscall(SYS_close, file)); }
ssize_t write(int file, const void* bytes, std::size_t count, off_t offset) {
  return offset < 0 ? syscall(SYS_write, file, bytes, count)
                    : syscall(SYS_pwrite64, file, bytes, count, offset);
}
int truncate(int file, off_t size) { return static_cast<int>(syscall(SYS_ftruncate, file, size)); }
int sync(int file) { return static_cast<int>(syscall(SYS_fdatasync, file)); }
int rename(const char* from, const char* to) {
  return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}
int unlink(const char* path) { return static_cast<int>(syscall(SYS_unlinkat, AT_FDCWD, path, 0)); }
int makeDirectory(const char* path, mode_t mode) {
  return static_cast<int>(syscall(SYS_mkdirat, AT_FDCWD, path, mode));
}

}  // namespace palpate::simulation::calls

/// The functions of the C library that this program has instead: shared libraries (SQLite, HDF5,
/// the C++ library) find these first.
namespace {

using palpate::simulation::Disk;
namespace calls = palpate::simulation::calls;

template <class OnDisk, class Past>
auto either(OnDisk on_disk, Past past) {
  Disk* const disk = Disk::mounted();
  return disk == nullptr ? past() : on_disk(*disk);
}

mode_t modeOf(int flags, va_list& arguments) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, mode_t) : 0;
}

int openFile(const char* path, int flags, mode_t mode) {
  return either([&](Disk& disk) { return disk.open(path, flags, mode); },
                [&] { return calls::open(path, flags, mode); });
}

ssize_t writeFile(int file, const void* bytes, std::size_t count, off_t offset) {
  return either([&](Disk& disk) { return disk.write(file, bytes, count, offset); },
                [&] { return calls::write(file, bytes, count, offset); });
}

int truncateFile(int file, off_t size) {
  return either([&](Disk& disk) { return disk.truncate(file, size); },
                [&] { return calls::truncate(file, size); });
}

int syncFile(int file) {
  return either([&](Disk& disk) { return disk.sync(file); }, [&] { return calls::sync(file); });
}

int removeFile(const char* path) {
  return either([&](Disk& disk) { return disk.unlink(path); }, [&] { return calls::unlink(path); });
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = modeOf(flags, arguments);
  va_end(arguments);
  return openFile(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = modeOf(flags, arguments);
  va_end(arguments);
  return openFile(path, flags, mode);
}
/// How the C++ library opens the folders that it lists.
int openat(int folder, const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = modeOf(flags, arguments);
  va_end(arguments);
  if (Disk* const disk = Disk::mounted()) disk->reads();
  return static_cast<int>(syscall(SYS_openat, folder, path, flags, mode));
}
int close(int file) {
  return either([&](Disk& disk) { return disk.close(file); }, [&] { return calls::close(file); });
}
ssize_t write(int file, const void* bytes, std::size_t count) {
  return writeFile(file, bytes, count, -1);
}
ssize_t pwrite(int file, const void* bytes, std::size_t count, off_t offset) {
  return writeFile(file, bytes, count, offset);
}
ssize_t pwrite64(int file, const void* bytes, std::size_t count, off64_t offset) {
  return writeFile(file, bytes, count, offset);
}
int ftruncate(int file, off_t size) noexcept { return truncateFile(file, size); }
int ftruncate64(int file, off64_t size) noexcept { return truncateFile(file, size); }
int fsync(int file) { return syncFile(file); }
int fdatasync(int file) { return syncFile(file); }
int rename(const char* from, const char* to) noexcept {
  return either([&](Disk& disk) { return disk.rename(from, to); },
                [&] { return calls::rename(from, to); });
}
int unlink(const char* path) noexcept { return removeFile(path); }
int remove(const char* path) noexcept {
  if (removeFile(path) == 0) return 0;
  if (errno != EISDIR) return -1;
  return static_cast<int>(syscall(SYS_unlinkat, AT_FDCWD, path, AT_REMOVEDIR));
}
/// Whoever waits in this process waits for another one, and there is none.
int nanosleep(const timespec* /*wanted*/, timespec* /*left*/) { return 0; }
int mkdir(const char* path, mode_t mode) noexcept {
  return either([&](Disk& disk) { return disk.makeDirectory(path, mode); },
                [&] { return calls::makeDirectory(path, mode); });
}
}
