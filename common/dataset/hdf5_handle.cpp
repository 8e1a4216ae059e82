#include "common/dataset/hdf5_handle.hpp"

namespace palpate::hdf5 {

void silenceErrorStack() {
  if (H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr) < 0)
    throw failure("HDF5 could not be initialised");
}

std::string lastError() {
  std::string sentence;
  const auto keep_innermost = [](unsigned, const H5E_error2_t* error, void* text) -> herr_t {
    if (error->desc) *static_cast<std::string*>(text) = error->desc;
    return 1;  // stops the walk
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &sentence);
  return sentence.empty() ? "unknown HDF5 error" : sentence;
}

ElementType typeOf(Element element) {
  switch (element) {
    case Element::uint8:
      return {"uint8", 1, H5T_STD_U8LE};
    case Element::int16:
      return {"int16", 2, H5T_STD_I16LE};
    case Element::int32:
      return {"int32", 4, H5T_STD_I32LE};
    case Element::float32:
      return {"float32", 4, H5T_IEEE_F32LE};
    case Element::float64:
      return {"float64", 8, H5T_IEEE_F64LE};
  }
  return {"?", 0, H5I_INVALID_HID};
}

std::size_t countOf(const Shape& shape) {
  std::size_t count = 1;
  for (const hsize_t extent : shape) count *= extent;
  return count;
}

std::string describe(const Shape& shape) {
  return shape.empty() ? "scalar" : fmt::format("{}", fmt::join(shape, " x "));
}

}  // namespace palpate::hdf5
