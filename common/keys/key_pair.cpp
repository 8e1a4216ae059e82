#include "common/keys/key_pair.hpp"

#include <sodium.h>

#include <algorithm>

#include "common/base/error.hpp"

namespace palpate {
namespace {

void startSodium() {
  if (sodium_init() < 0) throw failure("libsodium could not be initialised");
}

}  // namespace

std::optional<KeyBytes> keyBytesOf(std::string_view hex) {
  KeyBytes bytes{};
  std::size_t found = 0;
  const bool valid = hex.size() == 2 * bytes.size() &&
                     sodium_hex2bin(bytes.data(), bytes.size(), hex.data(), hex.size(), nullptr,
                                    &found, nullptr) == 0 &&
                     found == bytes.size();
  return valid ? std::optional(bytes) : std::nullopt;
}

std::string hexOf(const KeyBytes& bytes) {
  std::string hex(2 * bytes.size() + 1, '\0');
  sodium_bin2hex(hex.data(), hex.size(), bytes.data(), bytes.size());
  hex.pop_back();
  return hex;
}

std::optional<PublicKey> PublicKey::fromHex(std::string_view hex) {
  const auto bytes = keyBytesOf(hex);
  return bytes ? std::optional(PublicKey(*bytes)) : std::nullopt;
}

std::optional<PublicKey> PublicKey::fromBytes(std::string_view bytes) {
  KeyBytes key{};
  if (bytes.size() != key.size()) return std::nullopt;
  std::ranges::copy(bytes, key.begin());
  return PublicKey(key);
}

std::string PublicKey::hex() const { return hexOf(bytes_); }
std::string PublicKey::shortHex() const { return hex().substr(0, 12); }

KeyPair KeyPair::make() {
  startSodium();
  KeyBytes secret{};
  randombytes_buf(secret.data(), secret.size());
  return KeyPair(secret);
}

KeyPair::KeyPair(const KeyBytes& secret) : secret_(secret) {
  startSodium();
  KeyBytes open{};
  if (crypto_scalarmult_base(open.data(), secret_.data()) != 0)
    throw failure("libsodium makes no public key of this secret");
  open_ = PublicKey(open);
}

KeyPair::~KeyPair() { sodium_memzero(secret_.data(), secret_.size()); }

}  // namespace palpate
