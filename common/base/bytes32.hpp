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

/// 32 bytes that name something: a hash, a key.
class Bytes32 {
 public:
  Bytes32() = default;  ///< all zero: of nothing
  /// BLAKE2b-256 of some bytes.
  static Bytes32 of(std::string_view bytes);
  /// From 64 hexadecimal digits; nothing if it is not that.
  static std::optional<Bytes32> fromHex(std::string_view hex);
  /// From exactly 32 raw bytes; nothing if there are not 32.
  static std::optional<Bytes32> fromBytes(std::string_view bytes);

  std::string hex() const;       ///< 64 digits
  std::string shortHex() const;  ///< the first 12, for messages
  /// Valid as long as this object.
  std::string_view bytes() const { return {reinterpret_cast<const char*>(data()), bytes_.size()}; }
  const std::uint8_t* data() const { return bytes_.data(); }
  std::uint8_t* data() { return bytes_.data(); }
  std::size_t size() const { return bytes_.size(); }
  auto operator<=>(const Bytes32&) const = default;

 private:
  std::array<std::uint8_t, 32> bytes_{};
};

/// Before libsodium is called directly; any number of times, from any thread. Error when it fails.
void startSodium();

/// That many bytes nobody can guess, from the system. Error when it gives none.
std::string randomBytes(std::size_t count);

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
