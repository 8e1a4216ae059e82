#include "common/dataset/hdf5_write_driver.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

namespace palpate::hdf5 {
namespace {

struct LostWrite {
  haddr_t at;
  std::string bytes;
};

/// The open file as HDF5 sees it; the base must come first.
struct OpenFile : H5FD_t {
  int descriptor = -1;
  haddr_t end_of_allocation = 0;
  haddr_t end_of_file = 0;
  int* error = nullptr;
  std::vector<LostWrite> lost;  ///< in the order in which they were made
};

OpenFile& fileOf(H5FD_t* file) { return *static_cast<OpenFile*>(file); }
const OpenFile& fileOf(const H5FD_t* file) { return *static_cast<const OpenFile*>(file); }

void remember(OpenFile& file, int error) {
  if (*file.error == 0) *file.error = error;
}

H5FD_t* openFile(const char* name, unsigned, hid_t access, haddr_t) {
  int* error = *static_cast<int* const*>(H5Pget_driver_info(access));
  const int descriptor = open(name, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    *error = errno;
    return nullptr;
  }
  auto file = std::make_unique<OpenFile>();
  file->descriptor = descriptor;
  file->error = error;
  return file.release();
}

herr_t closeFile(H5FD_t* base) {
  const std::unique_ptr<OpenFile> file(&fileOf(base));
  if (close(file->descriptor) != 0) remember(*file, errno);
  return 0;
}

herr_t queryFeatures(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

haddr_t endOfAllocation(const H5FD_t* file, H5FD_mem_t) { return fileOf(file).end_of_allocation; }

herr_t setEndOfAllocation(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  fileOf(file).end_of_allocation = end;
  return 0;
}

haddr_t endOfFile(const H5FD_t* file, H5FD_mem_t) { return fileOf(file).end_of_file; }

/// Reads what is there, in the file or among the lost writes; the rest is zero.
herr_t readFile(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t at, std::size_t size, void* buffer) {
  const OpenFile& file = fileOf(base);
  char* const bytes = static_cast<char*>(buffer);
  std::memset(bytes, 0, size);
  for (std::size_t done = 0; done < size;) {
    const ssize_t got =
        pread(file.descriptor, bytes + done, size - done, static_cast<off_t>(at + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return -1;
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  for (const LostWrite& write : file.lost) {
    const haddr_t first = std::max(at, write.at),
                  last = std::min<haddr_t>(at + size, write.at + write.bytes.size());
    if (first < last)
      std::memcpy(bytes + (first - at), write.bytes.data() + (first - write.at), last - first);
  }
  return 0;
}

herr_t writeFile(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t at, std::size_t size,
                 const void* buffer) {
  OpenFile& file = fileOf(base);
  const char* const bytes = static_cast<const char*>(buffer);
  for (std::size_t done = 0; done < size && *file.error == 0;) {
    const ssize_t put =
        pwrite(file.descriptor, bytes + done, size - done, static_cast<off_t>(at + done));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0)
      remember(file, errno);
    else
      done += static_cast<std::size_t>(put);
  }
  if (*file.error != 0) file.lost.push_back({at, std::string(bytes, size)});
  file.end_of_file = std::max<haddr_t>(file.end_of_file, at + size);
  return 0;
}

herr_t truncateFile(H5FD_t* base, hid_t, hbool_t) {
  OpenFile& file = fileOf(base);
  if (file.end_of_file == file.end_of_allocation) return 0;
  if (*file.error == 0 &&
      ftruncate(file.descriptor, static_cast<off_t>(file.end_of_allocation)) != 0)
    remember(file, errno);
  file.end_of_file = file.end_of_allocation;
  return 0;
}

H5FD_class_t driverClass() {
  H5FD_class_t driver{};
  driver.name = "palpate-write";
  driver.maxaddr = static_cast<haddr_t>(1) << 62;
  driver.fc_degree = H5F_CLOSE_WEAK;
  driver.fapl_size = sizeof(int*);
  driver.open = openFile;
  driver.close = closeFile;
  driver.query = queryFeatures;
  driver.get_eoa = endOfAllocation;
  driver.set_eoa = setEndOfAllocation;
  driver.get_eof = endOfFile;
  driver.read = readFile;
  driver.write = writeFile;
  driver.truncate = truncateFile;
  const H5FD_mem_t free_lists[H5FD_MEM_NTYPES] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(free_lists), std::end(free_lists), std::begin(driver.fl_map));
  return driver;
}

}  // namespace

WriteDriver::WriteDriver() {
  const H5FD_class_t driver = driverClass();
  driver_ = Handle(H5FDregister(&driver), H5FDunregister);
  if (driver_.get() < 0) throw failure("HDF5 took no file driver: {}", lastError());
}

void WriteDriver::useIn(hid_t file_access) {
  int* const error = &error_;
  if (H5Pset_driver(file_access, driver_.get(), &error) < 0)
    throw failure("HDF5 took no file driver: {}", lastError());
}

}  // namespace palpate::hdf5
