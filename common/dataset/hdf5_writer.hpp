#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/dataset/hdf5_handle.hpp"
#include "common/dataset/hdf5_write_driver.hpp"

namespace palpate::hdf5 {

/// Writes arrays of plain types and text attributes to a new HDF5 file whose bytes depend on
/// nothing but the calls: no time stamps. The file format is that of HDF5 1.10, the first one in
/// which all structure carries checksums.
///
/// Every array gets the attributes `unit` and `blake2b`. Errors name the file.
class Writer {
 public:
  /// Creates `file`, replacing what is there.
  explicit Writer(const std::filesystem::path& file);

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

  /// Closes the file. Error when the last bytes could not be written; the file is then not usable.
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
  void refuseWriteError() const;
  template <class Result>
  Result check(Result result, std::string_view what) const {
    refuseWriteError();
    return checked(result, name_, what);
  }

  std::string name_;
  WriteDriver driver_;
  Handle file_;  ///< after the driver that it is closed through
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
