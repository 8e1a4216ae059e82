#include "common/base/content_id.hpp"

#include <sodium.h>

#include "common/base/error.hpp"

namespace palpate {
namespace {

static_assert(sizeof(crypto_generichash_state) == 384);

crypto_generichash_state* stateIn(std::array<std::byte, 384>& storage) {
  return reinterpret_cast<crypto_generichash_state*>(storage.data());
}

}  // namespace

ContentHasher::ContentHasher() {
  if (sodium_init() < 0) throw failure("libsodium could not be initialised");
  crypto_generichash_init(stateIn(state_), nullptr, 0, 32);
}

void ContentHasher::add(std::string_view bytes) {
  crypto_generichash_update(stateIn(state_), reinterpret_cast<const unsigned char*>(bytes.data()),
                            bytes.size());
}

ContentId ContentHasher::finish() {
  std::array<char, 32> digest;
  crypto_generichash_final(stateIn(state_), reinterpret_cast<unsigned char*>(digest.data()),
                           digest.size());
  return *ContentId::fromBytes({digest.data(), digest.size()});
}

ContentId ContentId::of(std::string_view bytes) {
  ContentHasher hasher;
  hasher.add(bytes);
  return hasher.finish();
}

std::optional<ContentId> ContentId::fromHex(std::string_view hex) {
  ContentId id;
  std::size_t length = 0;
  // sodium_hex2bin alone would take fewer digits.
  if (hex.size() != 64 ||
      sodium_hex2bin(id.bytes_.data(), id.bytes_.size(), hex.data(), hex.size(), nullptr, &length,
                     nullptr) != 0 ||
      length != id.bytes_.size())
    return std::nullopt;
  return id;
}

std::optional<ContentId> ContentId::fromBytes(std::string_view bytes) {
  ContentId id;
  if (bytes.size() != id.bytes_.size()) return std::nullopt;
  std::memcpy(id.bytes_.data(), bytes.data(), bytes.size());
  return id;
}

std::string ContentId::hex() const {
  std::array<char, 65> text;
  sodium_bin2hex(text.data(), text.size(), bytes_.data(), bytes_.size());
  return text.data();
}

std::string ContentId::shortHex() const { return hex().substr(0, 12); }

std::string_view ContentId::bytes() const {
  return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()};
}

}  // namespace palpate
