/* A plug-in may use the library too: both headers in one file, and what they call alike stays
 * apart. */
#include <palpate.h>
#include <palpate_device.h>

typedef struct {
  palpate_profile profile;
  palpate_guarded_force guarded;
  palpate_device_limits limits;
} both;

size_t bytesOfBoth(palpate_device* device, uint32_t flags);
size_t bytesOfBoth(palpate_device* device, uint32_t flags) {
  return device != NULL && flags == PALPATE_READING_LOST ? (size_t)PALPATE_DEVICE_LOST
                                                         : sizeof(both);
}
