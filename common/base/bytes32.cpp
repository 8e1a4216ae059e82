#include "common/base/bytes32.hpp"

#include <sodium.h>

#include <algorithm>

#include "common/base/error.hpp"

namespace palpate {
namespace {

static_assert(sizeof(crypto_generichash_state) == 384);

crypto_generichash_state* stateIn(std::array<std::byte, 384>& storage) {
  return reinterpret_cast<crypto_generichash_state*>(storage.data());
}

}  // namespace

std::string hexOf(std::string_view bytes) {
  std::string text(2 * bytes.size() + 1, '\0');
  sodium_bin2hex(text.data(), text.size(), reinterpret_cast<const unsigned char*>(bytes.data()),
                 bytes.size());
  text.pop_back();
  return text;
}

std::string base64Of(std::string_view bytes) {
  std::string text(sodium_base64_encoded_len(bytes.size(), sodium_base64_VARIANT_ORIGINAL), '\0');
  sodium_bin2base64(text.data(), text.size(), reinterpret_cast<const unsigned char*>(bytes.data()),
                    bytes.size(), sodium_base64_VARIANT_ORIGINAL);
  text.pop_back();  // the terminating zero
  return text;
}

Bytes32 Bytes32::of(std::string_view bytes) {
  ContentHasher hasher;
  hasher.add(bytes);
  return hasher.finish();
}

std::optional<Bytes32> Bytes32::fromHex(std::string_view hex) {
  Bytes32 read;
  std::size_t length = 0;
  // Check the length here, because sodium_hex2bin also accepts fewer digits.
  if (hex.size() != 2 * read.size() ||
      sodium_hex2bin(read.data(), read.size(), hex.data(), hex.size(), nullptr, &length, nullptr) !=
          0 ||
      length != read.size())
    return std::nullopt;
  return read;
}

std::optional<Bytes32> Bytes32::fromBytes(std::string_view bytes) {
  Bytes32 read;
  if (bytes.size() != read.size()) return std::nullopt;
  std::ranges::copy(bytes, read.data());
  return read;
}

std::string Bytes32::shortHex() const { return hex().substr(0, 12); }

void startSodium() {
  if (sodium_init() < 0) throw failure("libsodium could not be initialised");
}

std::string randomBytes(std::size_t count) {
  startSodium();
  std::string bytes(count, '\0');
  randombytes_buf(bytes.data(), bytes.size());
  return bytes;
}

ContentHasher::ContentHasher() {
  startSodium();
  crypto_generichash_init(stateIn(state_), nullptr, 0, ContentId().size());
}

void ContentHasher::add(std::string_view bytes) {
  crypto_generichash_update(stateIn(state_), reinterpret_cast<const unsigned char*>(bytes.data()),
                            bytes.size());
}

ContentId ContentHasher::finish() {
  ContentId id;
  crypto_generichash_final(stateIn(state_), id.data(), id.size());
  return id;
}

}  // namespace palpate
