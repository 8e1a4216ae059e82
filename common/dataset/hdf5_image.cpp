#include "common/dataset/hdf5_image.hpp"

#include <cstdlib>
#include <cstring>

#include "common/base/assertion.hpp"

namespace palpate::hdf5 {

namespace {

constexpr std::size_t growth = std::size_t{1} << 20;  // bytes

/// The size of a file, from the superblock that it begins with: HDF5 tells only after it has set
/// aside more. File Format Specification 3.0, II.A, "Version 2 and 3".
std::size_t sizeOf(const char* file) {
  constexpr std::size_t version_at = 8, size_of_offsets_at = 9, end_of_file_at = 28;
  PALPATE_ASSERT(file[version_at] == 3 && file[size_of_offsets_at] == sizeof(haddr_t),
                 "Writer asks for the format of HDF5 1.10");
  haddr_t end = 0;
  std::memcpy(&end, file + end_of_file_at, sizeof end);
  return end;
}

}  // namespace

FileImage::~FileImage() { std::free(bytes_); }

// What HDF5 leaves unused between its structures must be zero: equal calls, equal bytes.
void* FileImage::resize(void* bytes, std::size_t size, H5FD_file_image_op_t, void* image) {
  auto& self = *static_cast<FileImage*>(image);
  auto* const resized = static_cast<char*>(std::realloc(bytes, size));
  if (resized == nullptr) return nullptr;
  if (size > self.size_) std::memset(resized + self.size_, 0, size - self.size_);
  self.size_ = size;
  return resized;
}

herr_t FileImage::keep(void* bytes, H5FD_file_image_op_t, void* image) {
  static_cast<FileImage*>(image)->bytes_ = bytes;
  return 0;
}

void FileImage::useIn(hid_t file_access) {
  H5FD_file_image_callbacks_t callbacks = {};
  callbacks.image_realloc = resize;
  callbacks.image_free = keep;
  callbacks.udata_copy = [](void* image) { return image; };
  callbacks.udata_free = [](void*) -> herr_t { return 0; };
  callbacks.udata = this;
  if (H5Pset_fapl_core(file_access, growth, false) < 0 ||
      H5Pset_file_image_callbacks(file_access, &callbacks) < 0)
    throw failure("HDF5 makes no files in memory: {}", lastError());
}

std::string_view FileImage::finish(Handle& file, std::string_view name) {
  checked(file.close(), name, "cannot finish the file");
  PALPATE_ASSERT(bytes_ != nullptr, "closing the file hands its memory over");
  const auto* const bytes = static_cast<const char*>(bytes_);
  PALPATE_ASSERT(sizeOf(bytes) <= size_, "the memory holds the whole file");
  return {bytes, sizeOf(bytes)};
}

}  // namespace palpate::hdf5
