#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "common/dataset/hdf5_image.hpp"
#include "common/dataset/hdf5_list.hpp"

namespace palpate::hdf5 {

/// Writes arrays of plain types and text attributes to a new HDF5 file whose bytes depend on
/// nothing but the calls: no time stamps. The file format is that of HDF5 1.10, the first one in
/// which all structure carries checksums. Until close() the whole file is in memory, once
/// (FileImage).
///
/// Every array gets the attributes `unit` and `blake2b`. Errors name the file.
class Writer {
 public:
  /// Creates `file`, empty, replacing what is there. Error when that is impossible.
  explicit Writer(const std::filesystem::path& file);
  const std::string& name() const { return name_; }  ///< of the file, for errors

  void makeGroup(const std::string& path);
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
    using Number = typename Stored<T>::Number;
    write(path, shapeOfList<T>(list.size()),
          std::span(reinterpret_cast<const Number*>(list.data()), list.size() * numbersPerRow<T>()),
          unit);
  }

  /// Writes the file, which is for the caller to flush to disk (replaceFile). To be called once, at
  /// the end. Error when it could not be written; the file is then not usable.
  void close();

  const std::vector<ArrayInfo>& arrays() const { return arrays_; }  ///< written so far

 private:
  template <class T>
  friend class RowWriter;
  Handle create(const std::string& path, Element element, const Shape& shape, hid_t properties,
                const char* unit);
  void finish(hid_t dataset, ArrayInfo info);
  void writeBytes(const std::string& path, Element element, const Shape& shape,
                  std::string_view bytes, const char* unit);
  void setAttribute(hid_t object, const char* attribute, hid_t type, hid_t space,
                    const void* value);
  void setText(hid_t object, const char* attribute, std::string_view text);
  template <class Result>
  Result check(Result result, std::string_view what) const {
    return checked(result, name_, what);
  }

  std::string name_;
  std::ofstream disk_;
  FileImage image_;
  Handle file_;  ///< after the image, which it must be closed before
  std::vector<ArrayInfo> arrays_;
};

/// An array of float32 or int16 written row by row (first index), one gzip+shuffle chunk per row.
/// Rows that are skipped take no room and read as NaN, or as the lowest int16. Rows must come in
/// order, each exactly once. The Writer must outlive it.
template <class T>
class RowWriter {
 public:
  RowWriter(Writer& writer, std::string path, Shape shape, const char* unit);
  void write(std::span<const T> row);
  void skip();
  void finish();  ///< after the last row

 private:
  Writer& writer_;
  ArrayInfo info_;
  Handle dataset_, file_space_, row_space_;
  hsize_t next_ = 0;
  ContentHasher hasher_;
  std::vector<T> no_values_;  ///< what a skipped row reads as
};

extern template class RowWriter<float>;
extern template class RowWriter<std::int16_t>;

}  // namespace palpate::hdf5
