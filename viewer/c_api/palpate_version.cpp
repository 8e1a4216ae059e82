#include "viewer/c_api/palpate.h"

static_assert(PALPATE_ABI_VERSION == PALPATE_SOVERSION, "libpalpate.so.N carries the ABI version");

const char* palpate_version() { return PALPATE_VERSION; }

int32_t palpate_abi_version() { return PALPATE_ABI_VERSION; }
