#pragma once

#include <hdf5.h>

#include <Eigen/Core>
#include <vector>

#include "common/base/bytes32.hpp"
#include "common/base/error.hpp"

/// What datasets and recordings need of the HDF5 C API. Not thread-safe, as the library is not. For
/// common/dataset, viewer/haptics/recording.cpp, viewer/report/dataset_facts.cpp and the main() of
/// programs only.
namespace palpate::hdf5 {

/// Turns off HDF5's own printing to stderr; called by every Reader and Writer.
void silenceErrorStack();

/// Lets HDF5 leave alone, when the process ends, files that it could not close: 1.10.8 crashes over
/// one whose disk was full. For programs that write, before any other call of HDF5. Not for
/// libpalpate: others in its process (h5py) may rely on that their files are closed.
void leaveOpenFilesAtExit() noexcept;

/// Why the last call failed: the system's words ("No space left on device") where it refused
/// something, else the innermost sentence of HDF5's error stack, or "unknown".
std::string lastError();

/// Returns what an HDF5 call returned. A negative value becomes an Error "FILE: WHAT: HDF5's
/// reason".
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
  /// Closes now and returns the status, which for a file tells whether its last bytes could be
  /// written.
  herr_t close() { return id_ < 0 ? 0 : close_(std::exchange(id_, H5I_INVALID_HID)); }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

/// The element types a dataset uses; all little-endian.
enum class Element : std::uint8_t { uint8, int16, int32, float32, float64 };
inline constexpr std::array all_elements = {Element::uint8, Element::int16, Element::int32,
                                            Element::float32, Element::float64};
struct ElementType {
  std::string_view name;  ///< "int32"
  std::size_t size;       ///< bytes
  hid_t id;               ///< a library constant, not to be closed
};
/// How values of an element lie in a file.
ElementType typeOf(Element element);

/// The one whose values are T's.
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

/// How one entry of a list lies in an array: so many numbers, `extents` slowest first.
template <class NumberInFile, hsize_t... extents>
struct Row {
  using Number = NumberInFile;
  static constexpr std::size_t size = (std::size_t{1} * ... * extents);
  /// Of a list with so many rows.
  static Shape shape(hsize_t rows) { return {rows, extents...}; }
};

using RowMajorMatrix3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// The row of a T, whose bytes are those of T in memory. Enumerators are their values; int32 holds
/// the bits of uint32, which the file does not have.
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
  ContentId hash;  ///< BLAKE2b-256 of the values, row-major, little-endian
};

/// The name of a file, and what becomes of HDF5's answers about it: what Reader and Writer share.
class NamedFile {
 public:
  explicit NamedFile(std::string name) : name_(std::move(name)) { silenceErrorStack(); }
  const std::string& name() const { return name_; }  ///< of the file, for errors

  /// checked() of a call about this file.
  template <class Result>
  Result check(Result result, std::string_view what) const {
    return checked(result, name_, what);
  }
  /// The identifier that a call returned, checked, in a handle that closes it.
  Handle own(hid_t id, Handle::Close closer, std::string_view what) const {
    return {check(id, what), closer};
  }
  /// Selects rows `first`, first + 1, ... of an array whose whole space is `space`, and
  /// returns their shape.
  Shape selectRows(const Handle& space, const ArrayInfo& info, hsize_t first, hsize_t count) const;

 private:
  std::string name_;
};

/// Name of the attribute that holds an array's hash as 64 hexadecimal digits.
inline constexpr const char* hash_attribute = "blake2b";

}  // namespace palpate::hdf5
