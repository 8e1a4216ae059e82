#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>

#include "common/dataset/hdf5_handle.hpp"

namespace palpate::hdf5 {

/// Writes arrays of plain types and text attributes to a new HDF5 file whose bytes depend on
/// nothing but the calls: no time stamps. The file format is that of HDF5 1.10, the first one in
/// which all structure carries checksums.
///
/// Until close() HDF5 makes the whole file in memory, once, with its core driver (compressed fields
/// of some GB at most): what this object then writes to disk, it can also fail to write. (HDF5's
/// POSIX driver reports a full disk, after which 1.10.8 cannot close the file any more and the
/// process dies in its exit handler.)
///
/// Every array gets the attributes `unit` and `blake2b`. Errors name the file.
class Writer : public NamedFile {
 public:
  /// Creates `file`, empty, replacing what is there. Error when that is impossible.
  explicit Writer(const std::filesystem::path& file);
  Writer(const Writer&) = delete;  // HDF5 keeps the place of image_

  void makeGroup(const std::string& path);  ///< whose parent is there
  /// An attribute of a group or an array that was written: text, a short list, or one number.
  void setText(const std::string& object, const char* attribute, std::string_view text);
  void setIntegers(const std::string& object, const char* attribute,
                   std::span<const std::int32_t> values);
  void setNumber(const std::string& object, const char* attribute, double value);

  /// One array, written whole, contiguous. values.size() must be the product of the shape.
  template <class T>
  void write(const std::string& path, const Shape& shape, std::span<const T> values,
             const char* unit) {
    writeBytes(path, elementOf<T>(), shape, bytesOf(values), unit);
  }

  /// A list, one row for each entry.
  template <class T>
  void writeList(const std::string& path, const std::vector<T>& list, const char* unit) {
    using Entry = Stored<T>;
    static_assert(sizeof(T) == Entry::size * sizeof(typename Entry::Number));
    writeBytes(path, elementOf<typename Entry::Number>(), Entry::shape(list.size()),
               bytesOf(std::span(list)), unit);
  }

  /// Writes the file, which is for the caller to flush to disk (replaceFile). To be called once, at
  /// the end. Error when it could not be written; the file is then not usable.
  void close();

  const std::vector<ArrayInfo>& arrays() const { return arrays_; }  ///< written so far

 private:
  friend class RowWriter;
  Handle create(const std::string& path, Element element, const Shape& shape, hid_t properties,
                const char* unit);
  /// Names the hash of an array that is complete, and closes it.
  void finish(Handle& dataset, ArrayInfo info);
  void writeBytes(const std::string& path, Element element, const Shape& shape,
                  std::string_view bytes, const char* unit);
  void setAttribute(const Handle& object, const char* attribute, hid_t type, hid_t space,
                    const void* value);
  void setText(const Handle& object, const char* attribute, std::string_view text);
  Handle open(const std::string& object) const;

  /// Makes H5Fcreate with these file access properties create the file in image_.
  void useImage(hid_t file_access);

  struct Image {
    std::unique_ptr<void, decltype(&std::free)> bytes = {nullptr, &std::free};  ///< once closed
    std::size_t size = 0;  ///< of the memory, of which the file is the beginning
  };

  std::ofstream disk_;
  Image image_;
  Handle file_;  ///< after the image, which it must be closed before
  std::vector<ArrayInfo> arrays_;
};

/// An array of float32 or int16 written row by row (first index), one gzip+shuffle chunk per row.
/// Rows that are skipped take no room and read as NaN, or as the lowest int16. Rows must come in
/// order, each exactly once. The Writer must outlive it.
class RowWriter {
 public:
  RowWriter(Writer& writer, std::string path, Element element, Shape shape, const char* unit);
  void write(std::string_view row);  ///< bytes of the values
  void skip();
  void finish();  ///< after the last row

 private:
  Writer& writer_;
  ArrayInfo info_;
  Handle dataset_, file_space_, row_space_;
  hsize_t next_ = 0;
  ContentHasher hasher_;
  std::string no_values_;  ///< what a skipped row reads as
};

}  // namespace palpate::hdf5
