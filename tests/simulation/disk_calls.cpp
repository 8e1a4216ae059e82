#include "tests/simulation/disk_calls.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <ctime>
#include <type_traits>

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

/// Functions of the C library that this program replaces: shared libraries (SQLite, HDF5, the C++
/// library) find these first.
namespace {

using palpate::simulation::Disk;
namespace calls = palpate::simulation::calls;

/// Calls the disk if one is mounted, otherwise the real function.
template <class Result, class... Arguments>
Result either(Result (Disk::*on_disk)(Arguments...), Result (*past)(Arguments...),
              std::type_identity_t<Arguments>... arguments) {
  Disk* const disk = Disk::mounted();
  return disk == nullptr ? past(arguments...) : (disk->*on_disk)(arguments...);
}

mode_t modeOf(int flags, va_list& arguments) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, mode_t) : 0;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = modeOf(flags, arguments);
  va_end(arguments);
  return either(&Disk::open, calls::open, path, flags, mode);
}
int open64(const char* path, int flags, ...) __attribute__((alias("open")));
/// The C++ library opens the folders that it lists with this function.
int openat(int folder, const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = modeOf(flags, arguments);
  va_end(arguments);
  if (Disk* const disk = Disk::mounted()) disk->reads();
  return static_cast<int>(syscall(SYS_openat, folder, path, flags, mode));
}
int close(int file) { return either(&Disk::close, calls::close, file); }
ssize_t write(int file, const void* bytes, std::size_t count) {
  return either(&Disk::write, calls::write, file, bytes, count, -1);
}
ssize_t pwrite(int file, const void* bytes, std::size_t count, off_t offset) {
  return either(&Disk::write, calls::write, file, bytes, count, offset);
}
ssize_t pwrite64(int, const void*, std::size_t, off64_t) __attribute__((alias("pwrite")));
int ftruncate(int file, off_t size) noexcept {
  return either(&Disk::truncate, calls::truncate, file, size);
}
int ftruncate64(int, off64_t) noexcept __attribute__((alias("ftruncate")));
int fsync(int file) { return either(&Disk::sync, calls::sync, file); }
int fdatasync(int) __attribute__((alias("fsync")));
int rename(const char* from, const char* to) noexcept {
  return either(&Disk::rename, calls::rename, from, to);
}
int unlink(const char* path) noexcept { return either(&Disk::unlink, calls::unlink, path); }
int remove(const char* path) noexcept {
  if (unlink(path) == 0) return 0;
  if (errno != EISDIR) return -1;
  return static_cast<int>(syscall(SYS_unlinkat, AT_FDCWD, path, AT_REMOVEDIR));
}
/// Threads of this process only wait for other processes, and there are none.
int nanosleep(const timespec* /*wanted*/, timespec* /*left*/) { return 0; }
int mkdir(const char* path, mode_t mode) noexcept {
  return either(&Disk::makeDirectory, calls::makeDirectory, path, mode);
}
}
