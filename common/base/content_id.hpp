#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "common/base/bytes32.hpp"

namespace palpate {

/// Names a start configuration, a problem or a dataset by what is in it: its BLAKE2b-256.
using ContentId = Bytes32;

/// Feeds bytes piece by piece into one ContentId. Not thread-safe.
class ContentHasher {
 public:
  ContentHasher();
  void add(std::string_view bytes);
  /// The id of everything added. Call once.
  ContentId finish();

 private:
  alignas(64) std::array<std::byte, 384> state_;  ///< crypto_generichash_state
};

/// The bytes of a contiguous array of plain values, for hashing and sending. Little-endian machines
/// only.
template <class T>
std::string_view bytesOf(std::span<T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

}  // namespace palpate
