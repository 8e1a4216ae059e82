#pragma once

#include <filesystem>

#include "common/dataset/hdf5_handle.hpp"

namespace palpate::hdf5 {

/// Writes arrays of plain types and text attributes to a new HDF5 file whose bytes depend on
/// nothing but the calls: no time stamps. The file format is that of HDF5 1.10, the first one in
/// which all structure carries checksums.
///
/// The memory that this takes does not grow with the file. A disk that takes no more is told by
/// the call that finds out, at the latest by close(): the file is then to be removed, and the
/// process must not let HDF5 look for it when it ends (leaveOpenFilesAtExit).
///
/// Every array gets the attributes `unit` and `blake2b`. Errors name the file.
class Writer : public NamedFile {
 public:
  /// Creates `file`, empty, replacing what is there. Error when that is impossible.
  explicit Writer(const std::filesystem::path& file);

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
  friend class ListWriter;
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

  Handle file_;
  std::vector<ArrayInfo> arrays_;
};

/// A list whose rows come one after the other: the same bytes as by writeList, of which only some
/// are in memory. The Writer must outlive it.
class ListWriter {
 public:
  /// `shape`: how many rows there will be, and what is in one.
  ListWriter(Writer& writer, std::string path, Element element, Shape shape, const char* unit);
  void add(std::string_view row);
  void finish();  ///< after the last row

 private:
  void flush();

  Writer& writer_;
  ArrayInfo info_;
  std::size_t row_bytes_;
  Handle dataset_, file_space_;
  hsize_t written_ = 0;  ///< rows
  std::string pending_;
  ContentHasher hasher_;
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

/// The same of values.
template <class T>
class ListOf {
 public:
  ListOf(Writer& writer, std::string path, hsize_t rows, const char* unit)
      : list_(writer, std::move(path), elementOf<typename Stored<T>::Number>(),
              Stored<T>::shape(rows), unit) {
    static_assert(sizeof(T) == Stored<T>::size * sizeof(typename Stored<T>::Number));
  }
  void add(const T& value) { list_.add(bytesOf(std::span(&value, 1))); }
  void finish() { list_.finish(); }

 private:
  ListWriter list_;
};

}  // namespace palpate::hdf5
