#pragma once

#include "common/base/bytes32.hpp"

namespace palpate {

/// What of a key everybody may know: it names who holds the secret that belongs to it. Of
/// Curve25519, which ZeroMQ's CURVE speaks. All zero: nobody's.
using PublicKey = Bytes32;

/// A secret and what everybody may know of it. The secret is wiped from memory when it goes.
class KeyPair {
 public:
  /// A new one, from the system's randomness.
  static KeyPair make();
  /// Error when libsodium makes no public key of it.
  explicit KeyPair(const Bytes32& secret);
  KeyPair(const KeyPair&) = default;
  KeyPair& operator=(const KeyPair&) = default;
  ~KeyPair();

  const PublicKey& open() const { return open_; }
  const Bytes32& secret() const { return secret_; }

 private:
  Bytes32 secret_;
  PublicKey open_;
};

}  // namespace palpate
