#include "common/dataset/hdf5_file.hpp"

#include <H5FDpublic.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "common/base/error.hpp"
#include "common/base/whole_file.hpp"
#include "common/dataset/hdf5_handle.hpp"

namespace palpate::hdf5 {

/// What HDF5 calls. A driver's file begins with H5FD_t.
struct Driver {
  H5FD_t head;
  NewFile* file;
  haddr_t end;  ///< of what HDF5 has set aside

  static Driver& of(H5FD_t* file) { return *reinterpret_cast<Driver*>(file); }
  static const Driver& of(const H5FD_t* file) { return *reinterpret_cast<const Driver*>(file); }

  static H5FD_t* open(const char*, unsigned, hid_t file_access, haddr_t) {
    const void* const info = H5Pget_driver_info(file_access);
    if (info == nullptr) return nullptr;
    auto* const made = new Driver{};
    std::memcpy(&made->file, info, sizeof(void*));
    return &made->head;
  }
  static herr_t close(H5FD_t* file) {
    delete &of(file);
    return 0;
  }
  /// As HDF5's driver for files in memory, after which the layout of the file goes.
  static herr_t query(const H5FD_t*, unsigned long* flags) {
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
    return 0;
  }
  static haddr_t endOf(const H5FD_t* file, H5FD_mem_t) { return of(file).end; }
  static herr_t setEnd(H5FD_t* file, H5FD_mem_t, haddr_t end) {
    of(file).end = end;
    return 0;
  }
  static haddr_t size(const H5FD_t* file, H5FD_mem_t) { return of(file).file->size_; }
  static herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t count, void* bytes) {
    of(file).file->read(at, static_cast<char*>(bytes), count);
    return 0;
  }
  static herr_t write(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t count,
                      const void* bytes) {
    of(file).file->write(at, static_cast<const char*>(bytes), count);
    return 0;
  }
  static herr_t truncate(H5FD_t* file, hid_t, hbool_t closing) {
    if (closing) of(file).file->cutOff(of(file).end);
    return 0;
  }

  static hid_t id() {
    static const H5FD_class_t methods = [] {
      H5FD_class_t made = {};
#ifdef H5FD_CLASS_VERSION  // from HDF5 1.14 on
      made.version = H5FD_CLASS_VERSION;
      made.value = 511;  // of those that no driver is registered for
#endif
      made.name = "palpate";
      made.maxaddr = static_cast<haddr_t>(~std::size_t{0} - 1);
      made.fc_degree = H5F_CLOSE_WEAK;
      made.fapl_size = sizeof(void*);
      made.open = open;
      made.close = close;
      made.query = query;
      made.get_eoa = endOf;
      made.set_eoa = setEnd;
      made.get_eof = size;
      made.read = read;
      made.write = write;
      made.truncate = truncate;
      constexpr std::array<H5FD_mem_t, H5FD_MEM_NTYPES> pools = H5FD_FLMAP_DICHOTOMY;
      std::ranges::copy(pools, std::begin(made.fl_map));
      return made;
    }();
    static const hid_t registered = H5FDregister(&methods);
    return registered;
  }
};

NewFile::NewFile(const std::filesystem::path& path)
    : file_(open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
  if (file_ < 0) throw failure("{}: cannot be created: {}", path.string(), errnoText());
}

NewFile::~NewFile() {
  if (file_ >= 0) ::close(file_);
}

void NewFile::use(hid_t file_access) {
  const NewFile* const self = this;
  if (Driver::id() < 0 || H5Pset_driver(file_access, Driver::id(), &self) < 0)
    throw failure("HDF5 takes no driver: {}", lastError());
}

void NewFile::fail() {
  if (error_.empty()) error_ = errnoText();
}

void NewFile::write(std::uint64_t at, const char* bytes, std::size_t count) {
  constexpr std::size_t most_pending = std::size_t{1} << 20;
  const std::uint64_t end = pending_at_ + pending_.size();
  if (at < pending_at_ || at > end || pending_.size() + count > most_pending) {
    writePending();
    pending_at_ = at;
  }
  const std::size_t from = at - pending_at_;
  pending_.resize(std::max(pending_.size(), from + count));
  std::memcpy(pending_.data() + from, bytes, count);
  size_ = std::max(size_, at + count);
}

void NewFile::writePending() {
  if (error_.empty() && !writeAt(file_, pending_at_, pending_)) fail();
  if (!error_.empty() && !pending_.empty()) unwritten_.emplace_back(pending_at_, pending_);
  pending_.clear();
}

void NewFile::read(std::uint64_t at, char* bytes, std::size_t count) {
  writePending();
  std::memset(bytes, 0, count);
  std::size_t done = 0;
  while (done < count) {
    const ssize_t n = pread(file_, bytes + done, count - done, static_cast<off_t>(at + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail();
    if (n <= 0) break;
    done += static_cast<std::size_t>(n);
  }
  for (const auto& [from, text] : unwritten_) {
    const std::uint64_t first = std::max(at, from), last = std::min(at + count, from + text.size());
    if (first < last) std::memcpy(bytes + (first - at), text.data() + (first - from), last - first);
  }
}

void NewFile::cutOff(std::uint64_t size) {
  writePending();
  size_ = size;
  if (error_.empty() && ftruncate(file_, static_cast<off_t>(size)) != 0) fail();
}

void NewFile::close() {
  writePending();
  if (::close(std::exchange(file_, -1)) != 0) fail();
}

}  // namespace palpate::hdf5
