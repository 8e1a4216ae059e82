#include "common/dataset/hdf5_handle.hpp"

#include <cerrno>
#include <cstdlib>
#include <functional>
#include <numeric>

#include "common/base/assertion.hpp"

namespace palpate::hdf5 {

void silenceErrorStack() {
  if (H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr) < 0)
    throw failure("HDF5 could not be initialised");
}

void leaveOpenFilesAtExit() noexcept {
  // This variable could make HDF5 lock a file that the caller has already locked (replaceFile).
  unsetenv("HDF5_USE_FILE_LOCKING");
  // This fails if HDF5 was used before; there is no remedy then.
  static_cast<void>(H5dont_atexit());
}

std::string lastError() {
  std::string sentence;
  const auto keep_innermost = [](unsigned, const H5E_error2_t* error, void* text) -> herr_t {
    if (error->desc) *static_cast<std::string*>(text) = error->desc;
    return 1;  // stops the walk
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &sentence);
  // If a system call failed, the sentence contains its error code among other details ("..., errno
  // = 28, error message = ...").
  constexpr std::string_view key = "errno = ";
  if (const std::size_t at = sentence.find(key); at != std::string::npos)
    if (const int code = std::atoi(sentence.c_str() + at + key.size()); code > 0) {
      errno = code;
      return errnoText();
    }
  return sentence.empty() ? "unknown HDF5 error" : sentence;
}

ElementType typeOf(Element element) {
  // The table cannot be a constant: each macro H5T_... initialises the library, which assigns the
  // ids of types at run time.
  const auto types = std::to_array<ElementType>({{"uint8", 1, H5T_STD_U8LE},
                                                 {"int16", 2, H5T_STD_I16LE},
                                                 {"int32", 4, H5T_STD_I32LE},
                                                 {"float32", 4, H5T_IEEE_F32LE},
                                                 {"float64", 8, H5T_IEEE_F64LE}});
  return types.at(static_cast<std::size_t>(element));
}

std::size_t countOf(const Shape& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

std::string describe(const Shape& shape) {
  return shape.empty() ? "scalar" : fmt::format("{}", fmt::join(shape, " x "));
}

Shape NamedFile::selectRows(const Handle& space, const ArrayInfo& info, hsize_t first,
                            hsize_t count) const {
  PALPATE_ASSERT(!info.shape.empty() && first + count <= info.shape[0], "the rows must exist");
  Shape start(info.shape.size(), 0), counts = info.shape;
  start[0] = first;
  counts[0] = count;
  check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, counts.data(),
                            nullptr),
        info.path);
  return counts;
}

}  // namespace palpate::hdf5
