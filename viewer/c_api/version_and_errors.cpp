#include "viewer/c_api/arguments.hpp"

static_assert(PALPATE_ABI_VERSION == PALPATE_SOVERSION, "libpalpate.so.N carries the ABI version");

const char* palpate_version() { return PALPATE_VERSION; }

int32_t palpate_abi_version() { return PALPATE_ABI_VERSION; }

palpate::ErrorText& palpate::lastErrorText() noexcept {
  static thread_local ErrorText text{};
  return text;
}

const char* palpate_last_error() { return palpate::lastErrorText().data(); }
