#pragma once

#include <map>
#include <variant>

#include "common/dataset/hdf5_reader.hpp"
#include "common/dataset/hdf5_writer.hpp"
#include "tests/fuzz/fuzzer.hpp"

namespace palpate::fuzz {

/// An HDF5 file taken apart, changed, and written again with hashes that are right: what somebody
/// could write who means to deceive. (Without that every change ends at a hash.)
struct StoredArrays {
  struct Array {
    hdf5::Element element;
    hdf5::Shape shape;
    std::string bytes;
  };
  using Attribute = std::variant<std::string, std::vector<std::int32_t>, double>;

  std::map<std::string, Array> arrays;
  std::map<std::string, Attribute> attributes;  ///< of the root

  /// All arrays, and the attributes of these names.
  StoredArrays(const std::filesystem::path& file, const std::vector<const char*>& texts,
               const std::vector<const char*>& integers, const std::vector<const char*>& numbers);

  /// The next change that the input asks for.
  void change(Choices& choices);
  /// With every blake2b as it must be; an attribute content_hash, which covers those of a dataset,
  /// too.
  void write(const std::filesystem::path& file) const;

  /// A Script's part that overwrites an array's bytes from an offset on, and one that gives an
  /// array another number of rows.
  void overwriteIn(Script& script, const std::string& path, std::uint32_t offset,
                   std::string_view bytes) const;
  void resizeIn(Script& script, const std::string& path, std::uint16_t rows) const;

 private:
  unsigned char numberOf(const std::string& path) const;
};

}  // namespace palpate::fuzz
