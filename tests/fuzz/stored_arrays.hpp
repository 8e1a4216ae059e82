#pragma once

#include <map>
#include <variant>

#include "common/dataset/hdf5_reader.hpp"
#include "common/dataset/hdf5_writer.hpp"
#include "tests/fuzz/fuzzer.hpp"

namespace palpate::fuzz {

/// An HDF5 file that is taken apart, changed, and written again with correct hashes, as an attacker
/// could write it. Without correct hashes every change would end at a hash check.
struct StoredArrays {
  struct Array {
    hdf5::Element element;
    hdf5::Shape shape;
    std::string bytes;
  };
  using Attribute = std::variant<std::string, std::vector<std::int32_t>, double>;

  std::map<std::string, Array> arrays;
  std::map<std::string, Attribute> attributes;  ///< of the root group

  /// Reads all arrays, and the attributes with these names.
  StoredArrays(const std::filesystem::path& file, const std::vector<const char*>& texts,
               const std::vector<const char*>& integers, const std::vector<const char*>& numbers);

  /// Makes the next change in the input.
  void change(Choices& choices);
  /// Writes the file with correct blake2b hashes, including content_hash, which covers the hashes
  /// of a dataset.
  void write(const std::filesystem::path& file) const;

  /// Parts of a Script: one that overwrites an array's bytes from an offset on, and one that
  /// changes the number of an array's rows.
  void overwriteIn(Script& script, const std::string& path, std::uint32_t offset,
                   std::string_view bytes) const;
  void resizeIn(Script& script, const std::string& path, std::uint16_t rows) const;

 private:
  unsigned char numberOf(const std::string& path) const;
};

}  // namespace palpate::fuzz
