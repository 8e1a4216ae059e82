#pragma once

#include <filesystem>

#include "common/dataset/hdf5_handle.hpp"

namespace palpate::hdf5 {

class RowWriter;

/// Writes arrays of plain types and attributes to a new HDF5 file. The bytes of the file depend on
/// the calls alone (no time stamps). The file has the format of HDF5 1.10, the first version with
/// checksums on all structural data.
///
/// Memory use does not grow with the file. If the disk is full, the function that notices it
/// throws, at the latest close(). The caller must then remove the file. The program must have kept
/// HDF5 from closing open files when the process ends (leaveOpenFilesAtExit).
///
/// Every array gets the attributes `unit` and `blake2b`. Errors name the file.
class Writer : public NamedFile {
 public:
  /// Creates an empty `file`, replacing an existing one. Error if that is impossible.
  explicit Writer(const std::filesystem::path& file);

  void makeGroup(const std::string& path);  ///< its parent must exist
  /// Add an attribute to a group or to an array that is already written: a text, a short list of
  /// integers, or a number.
  void setText(const std::string& object, const char* attribute, std::string_view text);
  void setIntegers(const std::string& object, const char* attribute,
                   std::span<const std::int32_t> values);
  void setNumber(const std::string& object, const char* attribute, double value);

  /// Writes a list, one row per entry.
  template <class T>
  void writeList(const std::string& path, const std::vector<T>& list, const char* unit);
  /// Starts a list of `rows` entries of type T that are added one by one.
  template <class T>
  RowWriter list(const std::string& path, hsize_t rows, const char* unit);

  /// Closes the file. Must be called once, after everything is written. The caller must flush the
  /// file to disk (replaceFile). Error if writing failed; the file is then unusable.
  void close();

  const std::vector<ArrayInfo>& arrays() const { return arrays_; }  ///< arrays written so far

 private:
  friend class RowWriter;
  Handle create(const std::string& path, Element element, const Shape& shape, hid_t properties,
                const char* unit);
  /// Stores the hash of an array as its attribute and closes the array.
  void finish(Handle& dataset, ArrayInfo info);
  void setAttribute(const Handle& object, const char* attribute, hid_t type, hid_t space,
                    const void* value);
  void setText(const Handle& object, const char* attribute, std::string_view text);
  Handle open(const std::string& object) const;

  Handle file_;
  std::vector<ArrayInfo> arrays_;
};

/// Layout of the rows of an array in the file: contiguous, or one chunk per row, compressed with
/// the shuffle and gzip filters (float32 and int16 only).
enum class RowLayout : std::uint8_t { contiguous, compressed };

/// Writes an array row by row, in order of the first index, and keeps only about 1 MiB in memory.
/// The Writer must outlive this object.
class RowWriter {
 public:
  /// `shape` holds the number of rows, then the shape of a row.
  RowWriter(Writer& writer, std::string path, Element element, Shape shape, const char* unit,
            RowLayout layout = RowLayout::contiguous);
  void addBytes(std::string_view row);  ///< the bytes of one row's values
  template <class T>
  void add(const T& row) {
    addBytes(bytesOf(std::span(&row, 1)));
  }
  /// Skips a row of a compressed array. The row takes no space in the file. Readers get NaN for its
  /// values, or the lowest int16.
  void skip();
  void finish();  ///< call after the last row

 private:
  void flush();

  Writer& writer_;
  ArrayInfo info_;
  RowLayout layout_;
  std::size_t row_bytes_;
  Handle dataset_, file_space_;
  hsize_t next_ = 0;     ///< index of the next row to add
  std::string pending_;  ///< bytes of added rows that are not in the file yet
  ContentHasher hasher_;
  std::string no_values_;  ///< the bytes that a skipped row reads as
};

template <class T>
RowWriter Writer::list(const std::string& path, hsize_t rows, const char* unit) {
  using Entry = Stored<T>;
  static_assert(sizeof(T) == Entry::size * sizeof(typename Entry::Number));
  return {*this, path, elementOf<typename Entry::Number>(), Entry::shape(rows), unit};
}

template <class T>
void Writer::writeList(const std::string& path, const std::vector<T>& list, const char* unit) {
  RowWriter rows = this->list<T>(path, list.size(), unit);
  for (const T& entry : list) rows.add(entry);
  rows.finish();
}

}  // namespace palpate::hdf5
