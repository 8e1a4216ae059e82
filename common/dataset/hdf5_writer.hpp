#pragma once

#include <filesystem>

#include "common/dataset/hdf5_handle.hpp"

namespace palpate::hdf5 {

class RowWriter;

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
  /// The same of `rows` entries of type T that are added one after the other.
  template <class T>
  RowWriter list(const std::string& path, hsize_t rows, const char* unit);

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

  Handle file_;
  std::vector<ArrayInfo> arrays_;
};

/// How the rows of an array lie in the file: one after the other; or a gzip+shuffle chunk for each,
/// of float32 or int16.
enum class RowLayout : std::uint8_t { contiguous, compressed };

/// An array whose rows (first index) come one after the other, of which about a mebibyte is in
/// memory. A contiguous one is the same bytes as written whole. The Writer must outlive it.
class RowWriter {
 public:
  /// `shape`: how many rows there will be, and what is in one.
  RowWriter(Writer& writer, std::string path, Element element, Shape shape, const char* unit,
            RowLayout layout = RowLayout::contiguous);
  void addBytes(std::string_view row);  ///< bytes of the values
  template <class T>
  void add(const T& row) {
    addBytes(bytesOf(std::span(&row, 1)));
  }
  /// A row of a compressed array that takes no room and reads as NaN, or as the lowest int16.
  void skip();
  void finish();  ///< after the last row

 private:
  void flush();

  Writer& writer_;
  ArrayInfo info_;
  RowLayout layout_;
  std::size_t row_bytes_;
  Handle dataset_, file_space_;
  hsize_t next_ = 0;     ///< row
  std::string pending_;  ///< the rows before it, which are not in the file yet
  ContentHasher hasher_;
  std::string no_values_;  ///< what a skipped row reads as
};

template <class T>
RowWriter Writer::list(const std::string& path, hsize_t rows, const char* unit) {
  using Entry = Stored<T>;
  static_assert(sizeof(T) == Entry::size * sizeof(typename Entry::Number));
  return {*this, path, elementOf<typename Entry::Number>(), Entry::shape(rows), unit};
}

}  // namespace palpate::hdf5
