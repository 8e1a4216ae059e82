#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// The room that one array of a dataset takes.
struct ArraySize {
  std::string path;            ///< "/points/displacement"
  std::uint64_t stored = 0;    ///< bytes in the file, compressed
  std::uint64_t unpacked = 0;  ///< bytes of its values
};

/// Of every array of an HDF5 file, sorted by path. Nothing else of the file is looked at. Error
/// when it cannot be read. One thread at a time (HDF5 is not thread-safe).
std::vector<ArraySize> arraySizes(const std::filesystem::path& file);

}  // namespace palpate
