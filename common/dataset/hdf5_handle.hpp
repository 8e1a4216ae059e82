#pragma once

#include <hdf5.h>

#include <Eigen/Core>
#include <vector>

#include "common/base/bytes32.hpp"
#include "common/base/error.hpp"

/// Thin wrappers of the HDF5 C API for datasets and recordings. Like HDF5, they are not
/// thread-safe. Only common/dataset, scheduler/builds/build.cpp, viewer/haptics/recording.cpp,
/// viewer/report/dataset_facts.cpp and the main() of programs may use them.
namespace palpate::hdf5 {

/// Turns off HDF5's error output on stderr. Every Reader and Writer calls this.
void silenceErrorStack();

/// Keeps HDF5 from closing open files when the process ends. If a file could not be closed because
/// the disk is full, HDF5 1.10.8 would try again at the end and crash. Programs that write call
/// this before any other HDF5 function. libpalpate does not call it, because other code in its
/// process (h5py) may rely on HDF5 to close files at the end.
void leaveOpenFilesAtExit() noexcept;

/// Returns the reason why the last HDF5 call failed. It is the system's message ("No space left on
/// device") if a system call failed, else the innermost message of HDF5's error stack, or "unknown
/// HDF5 error".
std::string lastError();

/// Returns `result`, the result of an HDF5 call. If it is negative, the call has failed, and this
/// function throws Error "FILE: WHAT: REASON" with the reason from lastError().
template <class Result>
Result checked(Result result, std::string_view file, std::string_view what) {
  if (result < 0) throw failure("{}: {}: {}", file, what, lastError());
  return result;
}

/// Owns one HDF5 identifier.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Close closer) : id_(id), close_(closer) {}
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  hid_t get() const { return id_; }
  /// Closes the identifier now and returns the status, which is negative if that failed. The status
  /// of a file tells whether its last bytes were written.
  herr_t close() { return id_ < 0 ? 0 : close_(std::exchange(id_, H5I_INVALID_HID)); }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

/// Element types of a dataset; all little-endian.
enum class Element : std::uint8_t { uint8, int16, int32, float32, float64 };
inline constexpr std::array all_elements = {Element::uint8, Element::int16, Element::int32,
                                            Element::float32, Element::float64};
struct ElementType {
  std::string_view name;  ///< "int32"
  std::size_t size;       ///< bytes
  hid_t id;               ///< a library constant that must not be closed
};
/// Returns the storage type of an element in a file.
ElementType typeOf(Element element);

/// Returns the element type for values of type T.
template <class T>
constexpr Element elementOf() {
  if constexpr (std::is_same_v<T, std::uint8_t>) return Element::uint8;
  if constexpr (std::is_same_v<T, std::int16_t>) return Element::int16;
  if constexpr (std::is_same_v<T, std::int32_t>) return Element::int32;
  if constexpr (std::is_same_v<T, float>) return Element::float32;
  if constexpr (std::is_same_v<T, double>) return Element::float64;
}

using Shape = std::vector<hsize_t>;        ///< extents, slowest first; empty for a scalar
std::size_t countOf(const Shape& shape);   ///< product of the extents
std::string describe(const Shape& shape);  ///< "515 x 3"; "scalar"

/// Layout of a list in an array: each entry of the list is one row of numbers with the shape
/// `extents`, slowest first.
template <class NumberInFile, hsize_t... extents>
struct Row {
  using Number = NumberInFile;
  static constexpr std::size_t size = (std::size_t{1} * ... * extents);
  /// Returns the shape of a list with `rows` rows.
  static Shape shape(hsize_t rows) { return {rows, extents...}; }
};

using RowMajorMatrix3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// The Row that stores a T, with the same bytes as T in memory. Enumerators are stored as their
/// values. uint32 is stored as int32 with the same bits, because files have no uint32.
template <class T>
struct Stored : Row<T> {};
template <class T>
requires std::is_enum_v<T>
struct Stored<T> : Row<std::underlying_type_t<T>> {
};
template <>
struct Stored<std::uint32_t> : Row<std::int32_t> {};
template <std::size_t n>
struct Stored<std::array<std::int32_t, n>> : Row<std::int32_t, n> {};
template <>
struct Stored<ContentId> : Row<std::uint8_t, 32> {};
template <>
struct Stored<Eigen::Vector3d> : Row<double, 3> {};
template <>
struct Stored<RowMajorMatrix3d> : Row<double, 3, 3> {};

/// One array of a file and the hash of its bytes.
struct ArrayInfo {
  std::string path;  ///< "/lattice/ijk"
  Element element = Element::uint8;
  Shape shape;
  ContentId hash;            ///< BLAKE2b-256 of the values, row-major, little-endian
  std::uint64_t stored = 0;  ///< bytes in the file, compressed; only Reader sets it
};

/// Base of Reader and Writer: checks the results of HDF5 calls and names the file in errors.
class NamedFile {
 public:
  explicit NamedFile(std::string name) : name_(std::move(name)) { silenceErrorStack(); }
  const std::string& name() const { return name_; }  ///< for errors

  /// Calls checked() with the name of this file.
  template <class Result>
  Result check(Result result, std::string_view what) const {
    return checked(result, name_, what);
  }
  /// Checks the identifier that an HDF5 call returned, and returns a handle that owns it. Error if
  /// the call failed.
  Handle own(hid_t id, Handle::Close closer, std::string_view what) const {
    return {check(id, what), closer};
  }
  /// Selects rows `first`, first + 1, ... of an array with dataspace `space`; returns their shape.
  Shape selectRows(const Handle& space, const ArrayInfo& info, hsize_t first, hsize_t count) const;

 private:
  std::string name_;
};

/// Name of the attribute that holds an array's hash as 64 hexadecimal digits.
inline constexpr const char* hash_attribute = "blake2b";

}  // namespace palpate::hdf5
