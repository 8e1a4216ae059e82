#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

/// Files as bytes, for tests that damage them.
namespace palpate::test {

/// Throws if the file cannot be opened.
inline std::string bytesIn(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw failure("{}: cannot open", file.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Replaces the contents of a file. Throws if it cannot be written.
inline void putInto(const std::filesystem::path& file, std::string_view bytes) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) throw failure("{}: cannot write", file.string());
}

/// Flips bits of one byte.
inline void flip(const std::filesystem::path& file, std::uint64_t byte, int bits = 0x10) {
  std::string bytes = bytesIn(file);
  bytes.at(byte) = static_cast<char>(bytes.at(byte) ^ bits);
  putInto(file, bytes);
}

}  // namespace palpate::test
