#include "scheduler/service/lease_seal.hpp"

#include <sodium.h>

#include "common/base/assertion.hpp"
#include "common/base/bytes32.hpp"

namespace palpate {
namespace {

std::string bytesOfNumber(std::int64_t number) {
  return {reinterpret_cast<const char*>(&number), sizeof number};
}

}  // namespace

std::string keyedHash(std::string_view text, std::string_view secret) {
  startSodium();
  const auto bytes = [](std::string_view of) {
    return reinterpret_cast<const unsigned char*>(of.data());
  };
  std::string hash(crypto_generichash_BYTES_MIN, '\0');
  const int failed = crypto_generichash(reinterpret_cast<unsigned char*>(hash.data()), hash.size(),
                                        bytes(text), text.size(), bytes(secret), secret.size());
  PALPATE_ASSERT(failed == 0, "BLAKE2b must accept the length of the secret");
  return hash;
}

std::string bytesOf(const ResultKey& key) {
  std::string bytes = bytesOfNumber(key.space);
  for (const LatticePoint& point : {key.target, key.parent})
    for (const std::int32_t coordinate : point) bytes += bytesOfNumber(coordinate);
  return bytes;
}

std::string leaseSeal(const Leased& leased, std::string_view secret) {
  const auto& [worker, transition, start_id] = leased;
  // The text is unambiguous: only the worker's id and the last part vary in length, and the text
  // includes the length of the id.
  std::string text = bytesOfNumber(std::ssize(worker));
  text.append(worker).append(bytesOf(transition)).append(start_id);
  return keyedHash(text, secret);
}

bool isLeaseSeal(std::string_view seal, const Leased& leased, std::string_view secret) {
  const std::string own = leaseSeal(leased, secret);
  return seal.size() == own.size() && sodium_memcmp(own.data(), seal.data(), own.size()) == 0;
}

}  // namespace palpate
