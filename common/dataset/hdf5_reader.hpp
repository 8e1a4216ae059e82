#pragma once

#include <filesystem>

#include "common/dataset/hdf5_handle.hpp"

namespace palpate::hdf5 {

inline constexpr hsize_t any_extent = ~hsize_t{0};  ///< wildcard in an expected Shape

/// Words for error messages about a kind of file.
struct FileKind {
  std::string_view noun = "dataset";
  std::string_view origin = "palpate build makes one";
  std::string_view remedy = "copy the dataset again or seal it again with palpate build";
};

/// Returns whether this HDF5 file is marked as open for writing: a program is writing it, or has
/// ended without closing it. HDF5 then refuses to open the file, although its content may be
/// complete.
bool isOpenForWriting(const std::filesystem::path& file);

/// Reads files that Writer wrote, without trusting them: types, shapes and hashes are checked
/// before values are used. Accepts only arrays of the types in Element that are stored in the file
/// itself. Every Error names the file and the array.
class Reader : public NamedFile {
 public:
  /// Error (bad input) if `file` is missing, not a regular file or not an HDF5 file. Error if it is
  /// open for writing (isOpenForWriting), truncated or damaged.
  explicit Reader(const std::filesystem::path& file, const FileKind& kind = {});

  bool hasAttribute(const char* attribute) const;  ///< of the root group
  std::string text(const char* attribute) const;   ///< of the root group, fixed-length string
  std::vector<std::int32_t> integers(const char* attribute) const;  ///< root group, at most 1024
  double number(const char* attribute) const;                       ///< of the root group

  /// Finds all arrays of the file. Must be called once, before any of the functions below.
  void findArrays();
  const std::vector<ArrayInfo>& arrays() const { return arrays_; }  ///< sorted by path
  const ArrayInfo& array(const std::string& path) const;            ///< Error if it does not exist
  const ArrayInfo& array(const std::string& path, Element element,
                         const Shape& expected) const;  ///< also checks type and shape
  /// Returns the number of rows of an array that read() can read whole. Error for a scalar, and for
  /// nodal fields, which are read by rows.
  std::size_t rowsOf(const std::string& path) const;

  /// Reads a whole array and checks it against its hash.
  template <class T>
  std::vector<T> read(const std::string& path, const Shape& expected) const {
    const ArrayInfo& info = array(path, elementOf<T>(), expected);
    std::vector<T> values(countOf(info.shape));
    readBytes(info, std::as_writable_bytes(std::span(values)));
    return values;
  }
  /// Reads a list and checks it against its hash. If `rows` is given, the list must have this
  /// number of rows.
  template <class T>
  std::vector<T> readList(const std::string& path, hsize_t rows = any_extent) const {
    using Entry = Stored<T>;
    const ArrayInfo& info = array(path, elementOf<typename Entry::Number>(), Entry::shape(rows));
    std::vector<T> list(info.shape[0]);
    readBytes(info, std::as_writable_bytes(std::span(list)));
    return list;
  }
  /// Reads rows `first`, first + 1, ... until `values` is full. The caller must have checked type
  /// and shape with array(). The rows are not checked against the array's hash.
  template <class T>
  void readRows(const ArrayInfo& info, std::size_t first, std::span<T> values) const {
    readRowBytes(info, first, std::as_writable_bytes(values));
  }
  /// Reads a whole array and compares it with its hash.
  void verify(const ArrayInfo& info) const;

  /// Returns an Error "FILE: WHERE: WHY" for callers to throw if they find invalid data.
  Error damaged(std::string_view where, std::string_view why) const;

 private:
  struct Attribute;
  void readRowBytes(const ArrayInfo& info, std::size_t first, std::span<std::byte> bytes) const;
  void readBytes(const ArrayInfo& info, std::span<std::byte> bytes) const;
  ArrayInfo inspect(const std::string& path) const;
  std::string text(hid_t object, const char* attribute, std::string_view where) const;
  Handle openArray(const std::string& path) const;
  void checkHash(const ArrayInfo& info, const ContentId& hash) const;

  FileKind kind_;
  Handle file_;
  hsize_t file_size_ = 0;
  std::vector<ArrayInfo> arrays_;
};

}  // namespace palpate::hdf5
