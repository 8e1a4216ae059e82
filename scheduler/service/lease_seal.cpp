#include "scheduler/service/lease_seal.hpp"

#include <sodium.h>

#include "common/base/assertion.hpp"
#include "common/base/bytes32.hpp"

namespace palpate {
namespace {

constexpr std::size_t seal_bytes = crypto_generichash_BYTES_MIN;

/// Unambiguous: only the worker's id and the last part differ in length, and the id's is told.
std::string textOf(const Leased& leased) {
  std::string text;
  const auto add = [&](std::int64_t number) {
    text.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  add(std::ssize(leased.worker));
  text += leased.worker;
  add(leased.transition.space);
  for (const LatticePoint& point : {leased.transition.target, leased.transition.parent})
    for (const std::int32_t coordinate : point) add(coordinate);
  text += leased.start_id;
  return text;
}

const unsigned char* bytesOf(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

}  // namespace

LeaseSeal::LeaseSeal(std::string secret) : secret_(std::move(secret)) {
  startSodium();
  PALPATE_ASSERT(secret_.size() >= crypto_generichash_KEYBYTES_MIN &&
                     secret_.size() <= crypto_generichash_KEYBYTES_MAX,
                 "a secret of the length that BLAKE2b takes");
}

std::string LeaseSeal::sealOf(const Leased& leased) const {
  const std::string text = textOf(leased);
  std::string seal(seal_bytes, '\0');
  const int failed =
      crypto_generichash(reinterpret_cast<unsigned char*>(seal.data()), seal.size(), bytesOf(text),
                         text.size(), bytesOf(secret_), secret_.size());
  PALPATE_ASSERT(failed == 0, "the lengths are right");
  return seal;
}

bool LeaseSeal::isSealOf(const Leased& leased, std::string_view seal) const {
  return seal.size() == seal_bytes &&
         sodium_memcmp(sealOf(leased).data(), seal.data(), seal_bytes) == 0;
}

}  // namespace palpate
