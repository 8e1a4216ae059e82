/* Plug-ins with one fault each, chosen by a macro. */
#define _POSIX_C_SOURCE 200809L
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <time.h>

#include "palpate_device.h"

struct palpate_device {
  atomic_int halted;
};

static palpate_device the_device;

static int32_t enumerate(uint32_t index, char* id, size_t capacity) {
  if (index > 0) return PALPATE_DEVICE_FAILED;
  snprintf(id, capacity, "broken");
  return PALPATE_DEVICE_OK;
}

static palpate_device* open_device(const char* id, const char* options, char* error, size_t capacity) {
  (void)id, (void)options, (void)error, (void)capacity;
  return &the_device;
}

static int32_t limits(palpate_device* device, palpate_device_limits* limits) {
  (void)device;
  limits->max_force = limits->max_stiffness = limits->workspace_radius = 1;
  return PALPATE_DEVICE_OK;
}

/* HANGS: the device never answers, until it is halted. */
static int32_t read_state(palpate_device* device, palpate_device_state* state) {
  const struct timespec moment = {0, 1000000};
  (void)state;
  while (!atomic_load(&device->halted)) nanosleep(&moment, NULL);
  return PALPATE_DEVICE_LOST;
}

static int32_t write_force(palpate_device* device, const double force[3]) {
  (void)device, (void)force;
  return PALPATE_DEVICE_OK;
}

static void halt(palpate_device* device, int32_t halted) { atomic_store(&device->halted, halted); }

static const char* last_error(palpate_device* device) {
  (void)device;
  return "the cable is out";
}

static void close_device(palpate_device* device) { (void)device; }

static const palpate_device_plugin plugin = {
#ifdef SHORT_TABLE
    sizeof(palpate_device_plugin) - sizeof(void*),
#else
    sizeof(palpate_device_plugin),
#endif
#ifdef OLD_ABI
    PALPATE_DEVICE_ABI + 1,
#else
    PALPATE_DEVICE_ABI,
#endif
    "broken", enumerate, open_device, limits, read_state,
#ifdef NULL_ENTRY
    NULL,
#else
    write_force,
#endif
    halt, last_error, close_device};

#ifdef NO_ENTRY
PALPATE_DEVICE_EXPORT const palpate_device_plugin* another_function(void);
const palpate_device_plugin* another_function(void) { return &plugin; }
#else
const palpate_device_plugin* palpate_device_plugin_v1(void) { return &plugin; }
#endif
