#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace palpate {

/// BLAKE2b-256 of some bytes: names a start configuration, a problem or a dataset by what is in it.
class ContentId {
 public:
  ContentId() = default;  ///< all zero: "no content"
  static ContentId of(std::string_view bytes);
  /// From 64 hexadecimal digits; nothing if it is not that.
  static std::optional<ContentId> fromHex(std::string_view hex);
  /// From exactly 32 raw bytes; nothing if there are not 32.
  static std::optional<ContentId> fromBytes(std::string_view bytes);

  std::string hex() const;         ///< 64 digits
  std::string shortHex() const;    ///< the first 12, for messages
  std::string_view bytes() const;  ///< 32 raw bytes, valid as long as this object
  auto operator<=>(const ContentId&) const = default;

 private:
  std::array<std::uint8_t, 32> bytes_{};
};

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
