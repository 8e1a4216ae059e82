/* A haptic device as a plug-in of Palpate: a shared library that exports one function,
 *
 *     const palpate_device_plugin* palpate_device_plugin_v1(void);
 *
 * C99 and C++. See docs/devices.md, and deploy/examples/device-plugin for a whole one.
 *
 * Units: metres, newtons, seconds. Frame: right-handed, x to the right, y up, z toward the
 * operator, origin in the middle of the workspace (or the frame of the scene, when limits say so).
 *
 * Threads: Palpate makes one thread per open device; read() and write() are called by it alone, one
 * after the other, once per period, and may wait for the device (shortly: without a reading for 50
 * ms the device counts as lost and is halted; halt(0) comes after the next write()). open(),
 * limits(), close() and last_error() are called while that thread does not run, or by it. halt()
 * alone may be called by any thread at any time, also while read() or write() waits.
 *
 * Lifetimes: the table and its strings hold as long as the library is loaded; an open device from
 * open() to close(); the text of last_error() until the next call for that device. Nothing may
 * throw across this boundary.
 *
 * Sizes: every struct begins with its size in bytes. Who fills a struct writes no further than the
 * size it was given allows, so that later versions can append members. Nothing else about version 1
 * will change.
 */
#ifndef PALPATE_DEVICE_H
#define PALPATE_DEVICE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PALPATE_DEVICE_ABI 1u

#if defined(_WIN32)
#define PALPATE_DEVICE_EXPORT __declspec(dllexport)
#else
#define PALPATE_DEVICE_EXPORT __attribute__((visibility("default")))
#endif

/* One open device; the plug-in knows what it is. */
typedef struct palpate_device palpate_device;

/* What every call answers. */
enum palpate_device_result {
  PALPATE_DEVICE_OK = 0,
  PALPATE_DEVICE_FAILED =
      1, /* last_error() says why; the device may be tried again at the next period */
  PALPATE_DEVICE_LOST =
      2 /* unplugged; it is tried again at every period, and used when it is back */
};

typedef struct palpate_device_limits {
  uint32_t size;
  uint32_t has_buttons;    /* 0 or 1 */
  uint32_t lives_in_scene; /* 0 or 1: positions are in the frame of the scene */
  uint32_t reserved;
  double max_force;        /* N, > 0; no longer force is written */
  double max_stiffness;    /* N/m, > 0, of what the closed loop renders stably */
  double workspace_radius; /* m, > 0 */
} palpate_device_limits;

typedef struct palpate_device_state {
  uint32_t size;
  uint32_t buttons;   /* bit n: button n is down */
  double position[3]; /* m */
} palpate_device_state;

typedef struct palpate_device_plugin {
  uint32_t size;
  uint32_t abi;     /* PALPATE_DEVICE_ABI */
  const char* name; /* for a person, UTF-8: "Phantom Touch by OpenHaptics" */

  /* Writes the id of the device number `index` (from 0) and a 0 into `id`. FAILED: there are no
   * more. */
  int32_t (*enumerate)(uint32_t index, char* id, size_t capacity);

  /* Opens the device of that id; an empty id takes the first. `options` is text for the plug-in
   * alone, may be empty. NULL: it cannot be opened, and `error` says why (a sentence, at most
   * `capacity` bytes with its 0). The force is zero until the first write(). */
  palpate_device* (*open)(const char* id, const char* options, char* error, size_t capacity);

  /* Fills limits->... ; limits->size is set by the caller. */
  int32_t (*limits)(palpate_device* device, palpate_device_limits* limits);

  /* The newest state; state->size is set by the caller. */
  int32_t (*read)(palpate_device* device, palpate_device_state* state);

  /* The force on the hand, N, from now until the next call. Always finite and within max_force. */
  int32_t (*write)(palpate_device* device, const double force[3]);

  /* halted 1: the force becomes zero now and stays so, whatever is written, until it is called with
   * 0. Any thread. */
  void (*halt)(palpate_device* device, int32_t halted);

  /* Why the last call for this device failed, a sentence. */
  const char* (*last_error)(palpate_device* device);

  /* Zero force, and everything is given back. */
  void (*close)(palpate_device* device);
} palpate_device_plugin;

PALPATE_DEVICE_EXPORT const palpate_device_plugin* palpate_device_plugin_v1(void);
typedef const palpate_device_plugin* (*palpate_device_plugin_function)(void);

#ifdef __cplusplus
}
#endif

#endif
