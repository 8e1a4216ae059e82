#include "common/keys/key_pair.hpp"

#include <sodium.h>

#include "common/base/error.hpp"

namespace palpate {

KeyPair KeyPair::make() {
  startSodium();
  Bytes32 secret;
  randombytes_buf(secret.data(), secret.size());
  return KeyPair(secret);
}

KeyPair::KeyPair(const Bytes32& secret) : secret_(secret) {
  startSodium();
  if (crypto_scalarmult_base(open_.data(), secret_.data()) != 0)
    throw failure("this secret key has no public key; make a new one: palpate key new --replace");
}

KeyPair::~KeyPair() { sodium_memzero(secret_.data(), secret_.size()); }

}  // namespace palpate
