/* Plug-ins with one fault each, chosen by a macro. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <time.h>

#include "palpate_device.h"

struct palpate_device {
  atomic_int halted, started, reads, hanging, released;
  _Atomic double force, force_at_hang, longest_resumed;
};

static palpate_device the_device;

static int32_t enumerate(uint32_t index, char* id, size_t capacity) {
  if (index > 0) return PALPATE_DEVICE_FAILED;
  snprintf(id, capacity, "broken");
  return PALPATE_DEVICE_OK;
}

static palpate_device* open_device(const char* id, const char* options, char* error,
                                   size_t capacity) {
  (void)id, (void)options, (void)error, (void)capacity;
  return &the_device;
}

static int32_t limits(palpate_device* device, palpate_device_limits* limits) {
  (void)device;
  limits->max_force = limits->max_stiffness = limits->workspace_radius = 1;
#ifdef HANGS_PRESSING
  limits->max_force = 12;
  limits->lives_in_scene = 1;
#endif
  return PALPATE_DEVICE_OK;
}

#ifdef HANGS_PRESSING
/* HANGS_PRESSING: once started, the device comes from above a cube of 100 mm, presses 4 mm deep,
 * and then does not answer until it is released. */
static int32_t read_state(palpate_device* device, palpate_device_state* state) {
  const struct timespec moment = {0, 1000000};
  const int depth = 400, read = atomic_fetch_add(&device->reads, atomic_load(&device->started));
  if (read == depth) {
    device->force_at_hang = device->force;
    atomic_store(&device->hanging, 1);
    while (!atomic_load(&device->released)) nanosleep(&moment, NULL);
    atomic_store(&device->hanging, 0);
  }
  state->position[0] = 0.052, state->position[1] = 0.047;
  state->position[2] = 0.104 - 2e-5 * (read < depth ? read : depth);
  return PALPATE_DEVICE_OK;
}
#else
/* HANGS: the device does not answer until it is halted. */
static int32_t read_state(palpate_device* device, palpate_device_state* state) {
  const struct timespec moment = {0, 1000000};
  (void)state;
  while (!atomic_load(&device->halted)) nanosleep(&moment, NULL);
  return PALPATE_DEVICE_LOST;
}
#endif

static int32_t write_force(palpate_device* device, const double force[3]) {
  device->force = sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2]);
  return PALPATE_DEVICE_OK;
}

static void halt(palpate_device* device, int32_t halted) {
  if (!halted && device->force > device->longest_resumed) device->longest_resumed = device->force;
  atomic_store(&device->halted, halted);
}

/* The force on the hand, N, and other values for tests. */
PALPATE_DEVICE_EXPORT double broken_device_force(void);
double broken_device_force(void) { return atomic_load(&the_device.halted) ? 0 : the_device.force; }
PALPATE_DEVICE_EXPORT double broken_device_force_at_hang(void);
double broken_device_force_at_hang(void) { return the_device.force_at_hang; }
PALPATE_DEVICE_EXPORT double broken_device_longest_resumed(void);
double broken_device_longest_resumed(void) { return the_device.longest_resumed; }
PALPATE_DEVICE_EXPORT int broken_device_hangs(void);
int broken_device_hangs(void) { return atomic_load(&the_device.hanging); }
PALPATE_DEVICE_EXPORT int broken_device_is_halted(void);
int broken_device_is_halted(void) { return atomic_load(&the_device.halted); }
PALPATE_DEVICE_EXPORT void broken_device_start(void);
void broken_device_start(void) { atomic_store(&the_device.started, 1); }
PALPATE_DEVICE_EXPORT void broken_device_release(void);
void broken_device_release(void) { atomic_store(&the_device.released, 1); }

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
    "broken",
    enumerate,
    open_device,
    limits,
    read_state,
#ifdef NULL_ENTRY
    NULL,
#else
    write_force,
#endif
    halt,
    last_error,
    close_device};

#ifdef NO_ENTRY
PALPATE_DEVICE_EXPORT const palpate_device_plugin* another_function(void);
const palpate_device_plugin* another_function(void) { return &plugin; }
#else
const palpate_device_plugin* palpate_device_plugin_v1(void) { return &plugin; }
#endif
