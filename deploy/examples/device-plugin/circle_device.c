/* A minimal plug-in for palpate view --device plugin:LIB. The handle of its device moves by itself
 * on a small circle and yields to the force like a spring. Options: "radius=0.02" in metres.
 *
 *     cc -shared -fPIC -o circle_device.so circle_device.c
 */
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "palpate_device.h"

#define TURNS_PER_SECOND 0.5
#define COMPLIANCE 0.001 /* m/N */

struct palpate_device {
  double radius;
  struct timespec start;
  double force[3];
  atomic_int halted; /* halt() may be called while another thread reads */
};

static int32_t enumerate(uint32_t index, char* id, size_t capacity) {
  if (index > 0) return PALPATE_DEVICE_FAILED;
  snprintf(id, capacity, "circle");
  return PALPATE_DEVICE_OK;
}

static palpate_device* open_device(const char* id, const char* options, char* error,
                                   size_t capacity) {
  if (id[0] != '\0' && strcmp(id, "circle") != 0) {
    snprintf(error, capacity, "there is no device \"%s\", only \"circle\"", id);
    return NULL;
  }
  double radius = 0.02;
  if (options[0] != '\0' &&
      (sscanf(options, "radius=%lf", &radius) != 1 || !(radius > 0 && radius < 0.05))) {
    snprintf(error, capacity, "the option is radius=METRES, below 0.05, not \"%s\"", options);
    return NULL;
  }
  palpate_device* device = calloc(1, sizeof *device);
  if (device == NULL) {
    snprintf(error, capacity, "out of memory");
    return NULL;
  }
  device->radius = radius;
  clock_gettime(CLOCK_MONOTONIC, &device->start);
  return device;
}

static int32_t limits(palpate_device* device, palpate_device_limits* limits) {
  (void)device;
  limits->has_buttons = 0;
  limits->lives_in_scene = 0;
  limits->max_force = 5;
  limits->max_stiffness = 1000;
  limits->workspace_radius = 0.06;
  return PALPATE_DEVICE_OK;
}

static int32_t read_state(palpate_device* device, palpate_device_state* state) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  const double time = (double)(now.tv_sec - device->start.tv_sec) +
                      1e-9 * (double)(now.tv_nsec - device->start.tv_nsec);
  const double angle = 2 * 3.14159265358979323846 * TURNS_PER_SECOND * time;
  const double circle[3] = {device->radius * cos(angle), device->radius * sin(angle), 0};
  for (int axis = 0; axis < 3; ++axis)
    state->position[axis] = circle[axis] + (device->halted ? 0 : COMPLIANCE * device->force[axis]);
  state->buttons = 0;
  return PALPATE_DEVICE_OK;
}

static int32_t write_force(palpate_device* device, const double force[3]) {
  memcpy(device->force, force, sizeof device->force);
  return PALPATE_DEVICE_OK;
}

static void halt(palpate_device* device, int32_t halted) { device->halted = halted; }

static const char* last_error(palpate_device* device) {
  (void)device;
  return "";
}

static void close_device(palpate_device* device) { free(device); }

const palpate_device_plugin* palpate_device_plugin_v1(void) {
  static const palpate_device_plugin plugin = {sizeof(palpate_device_plugin),
                                               PALPATE_DEVICE_ABI,
                                               "circle",
                                               enumerate,
                                               open_device,
                                               limits,
                                               read_state,
                                               write_force,
                                               halt,
                                               last_error,
                                               close_device};
  return &plugin;
}
