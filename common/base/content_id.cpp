#include "common/base/content_id.hpp"

#include <sodium.h>

namespace palpate {
namespace {

static_assert(sizeof(crypto_generichash_state) == 384);

crypto_generichash_state* stateIn(std::array<std::byte, 384>& storage) {
  return reinterpret_cast<crypto_generichash_state*>(storage.data());
}

}  // namespace

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
