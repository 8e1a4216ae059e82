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

/// Returns the bytes in hexadecimal, two digits each.
std::string hexOf(std::string_view bytes);
/// Returns the bytes in base64 (RFC 4648), with padding.
std::string base64Of(std::string_view bytes);

/// 32 bytes that identify something: a hash or a key.
class Bytes32 {
 public:
  Bytes32() = default;  ///< 32 zero bytes, which identify nothing
  /// Returns the BLAKE2b-256 hash of `bytes`.
  static Bytes32 of(std::string_view bytes);
  /// Parses 64 hexadecimal digits; nullopt for anything else.
  static std::optional<Bytes32> fromHex(std::string_view hex);
  /// Copies 32 raw bytes; nullopt for any other length.
  static std::optional<Bytes32> fromBytes(std::string_view bytes);

  std::string hex() const { return hexOf(bytes()); }  ///< 64 digits
  std::string shortHex() const;                       ///< the first 12 digits, for messages
  /// Returns the bytes as a view, which is valid for the lifetime of this object.
  std::string_view bytes() const { return {reinterpret_cast<const char*>(data()), bytes_.size()}; }
  const std::uint8_t* data() const { return bytes_.data(); }
  std::uint8_t* data() { return bytes_.data(); }
  std::size_t size() const { return bytes_.size(); }
  auto operator<=>(const Bytes32&) const = default;

 private:
  std::array<std::uint8_t, 32> bytes_{};
};

/// Initialises libsodium. Call this before any direct call to libsodium. It may be called
/// repeatedly, from any thread. Error if the initialisation fails.
void startSodium();

/// Returns `count` unpredictable bytes from the system. Error if the system fails.
std::string randomBytes(std::size_t count);

/// Identifies a start configuration, a problem or a dataset by the BLAKE2b-256 hash of its content.
using ContentId = Bytes32;

/// Computes the ContentId of data that is added in parts. Not thread-safe.
class ContentHasher {
 public:
  ContentHasher();
  void add(std::string_view bytes);
  /// Returns the id of everything added. Call once.
  ContentId finish();

 private:
  alignas(64) std::array<std::byte, 384> state_;  ///< crypto_generichash_state
};

/// Returns the bytes of a contiguous array of plain values, for hashing and sending. For
/// little-endian machines only.
template <class T>
std::string_view bytesOf(std::span<T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

}  // namespace palpate
