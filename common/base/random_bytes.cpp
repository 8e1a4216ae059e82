#include "common/base/random_bytes.hpp"

#include <sodium.h>

#include "common/base/error.hpp"

namespace palpate {

std::string randomBytes(std::size_t count) {
  if (sodium_init() < 0) throw failure("libsodium could not be initialised");
  std::string bytes(count, '\0');
  randombytes_buf(bytes.data(), bytes.size());
  return bytes;
}

}  // namespace palpate
