#include "common/dataset/hdf5_image.hpp"

#include <cstdlib>
#include <cstring>

#include "common/base/assertion.hpp"

namespace palpate::hdf5 {
namespace {

constexpr std::size_t growth = std::size_t{1} << 20;  // bytes

}  // namespace

FileImage::~FileImage() { std::free(bytes_); }

// What HDF5 leaves unused between its structures must be zero too: equal calls, equal bytes.
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
  checked(H5Fflush(file.get(), H5F_SCOPE_LOCAL), name, "cannot finish the file");
  haddr_t size = 0;  // of the file: the memory, and H5Fget_file_image, go beyond it
  checked(H5Fget_eoa(file.get(), &size), name, "has no size");
  checked(file.close(), name, "cannot finish the file");
  PALPATE_ASSERT(bytes_ != nullptr && size <= size_, "closing the file hands its memory over");
  return {static_cast<const char*>(bytes_), size};
}

}  // namespace palpate::hdf5
