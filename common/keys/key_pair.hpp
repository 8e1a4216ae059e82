#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace palpate {

/// Of Curve25519, which ZeroMQ's CURVE speaks: 32 bytes.
using KeyBytes = std::array<std::uint8_t, 32>;

/// What of a key everybody may know: it names who holds the secret that belongs to it.
class PublicKey {
 public:
  PublicKey() = default;  ///< all zero: nobody's
  explicit PublicKey(const KeyBytes& bytes) : bytes_(bytes) {}
  /// From 64 hexadecimal digits; nothing if it is not that.
  static std::optional<PublicKey> fromHex(std::string_view hex);
  /// From exactly 32 raw bytes; nothing if there are not 32.
  static std::optional<PublicKey> fromBytes(std::string_view bytes);

  std::string hex() const;       ///< 64 digits
  std::string shortHex() const;  ///< the first 12, for messages
  const KeyBytes& bytes() const { return bytes_; }
  auto operator<=>(const PublicKey&) const = default;

 private:
  KeyBytes bytes_{};
};

/// A secret and what everybody may know of it. The secret is wiped from memory when it goes.
class KeyPair {
 public:
  /// A new one, from the system's randomness.
  static KeyPair make();
  explicit KeyPair(const KeyBytes& secret);
  KeyPair(const KeyPair&) = default;
  KeyPair& operator=(const KeyPair&) = default;
  ~KeyPair();

  const PublicKey& open() const { return open_; }
  const KeyBytes& secret() const { return secret_; }

 private:
  KeyBytes secret_;
  PublicKey open_;
};

/// 32 bytes of 64 hexadecimal digits; nothing if it is not that. And back.
std::optional<KeyBytes> keyBytesOf(std::string_view hex);
std::string hexOf(const KeyBytes& bytes);

}  // namespace palpate
