#pragma once

#include "common/base/bytes32.hpp"

namespace palpate {

/// The public part of a Curve25519 key, as in ZeroMQ's CURVE. It identifies the holder of the
/// secret part. The key of 32 zero bytes belongs to nobody.
using PublicKey = Bytes32;

/// A secret and its public key. The destructor wipes the secret from memory.
class KeyPair {
 public:
  /// Returns a new key from the system's random source.
  static KeyPair make();
  /// Error if libsodium cannot derive a public key from the secret.
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
