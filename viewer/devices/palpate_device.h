/* Interface of a Palpate plug-in for haptic devices. A plug-in is a shared library that exports one
 * function,
 *
 *     const palpate_device_plugin* palpate_device_plugin_v1(void);
 *
 * This header is valid C99 and C++. docs/devices.md explains it, and
 * deploy/examples/device-plugin is a complete plug-in.
 *
 * Units: metres, newtons, seconds. Frame: right-handed, x to the right, y up, z toward the
 * operator, origin in the middle of the workspace. A device with limits.lives_in_scene uses the
 * frame of the scene instead.
 *
 * Threads: Palpate creates one thread per open device. Only this thread calls read() and write():
 * once per period, first read(), then write(). Both may wait briefly for the device. open(),
 * limits(), close() and last_error() are called by the same thread, or while it does not run.
 * halt() may be called by any thread at any time, even while read() or write() waits.
 *
 * Lost devices: after 50 ms without a reading the device counts as lost, and Palpate calls halt()
 * with 1. When readings arrive again, it calls halt() with 0 after a successful write().
 *
 * Lifetimes: the palpate_device_plugin and its strings must be valid while the library is loaded,
 * an open device from open() to close(), and the text that last_error() returns until the next call
 * for that device.
 *
 * Exceptions: none of these functions may throw.
 *
 * Sizes: every struct starts with a member that holds its size in bytes. Code that fills in a
 * struct must not write beyond this size, so that later versions can append members. Version 1 will
 * not change in any other way.
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

/* An open device; opaque to Palpate. */
typedef struct palpate_device palpate_device;

/* Result codes of the calls. */
enum palpate_device_result {
  PALPATE_DEVICE_OK = 0,
  PALPATE_DEVICE_FAILED =
      1, /* last_error() gives the reason; the call may be repeated in the next period */
  PALPATE_DEVICE_LOST =
      2 /* unplugged; the call is repeated every period, until the device is back */
};

typedef struct palpate_device_limits {
  uint32_t size;
  uint32_t has_buttons;    /* 0 or 1 */
  uint32_t lives_in_scene; /* 1: positions are in the frame of the scene; 0: the device's own */
  uint32_t reserved;
  double max_force;        /* N, > 0; no larger force is written */
  double max_stiffness;    /* N/m, > 0; largest stiffness that the closed loop renders stably */
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
  const char* name; /* shown to the user, UTF-8: "Phantom Touch by OpenHaptics" */

  /* Writes the id of device number `index`, counted from 0, and a terminating 0 to `id`, which has
   * room for `capacity` bytes. Returns PALPATE_DEVICE_FAILED if there is no such device. */
  int32_t (*enumerate)(uint32_t index, char* id, size_t capacity);

  /* Opens the device with this id; an empty id selects the first device. `options` is text that
   * only the plug-in interprets; it may be empty. On failure returns NULL and writes the reason to
   * `error`, as a sentence of at most `capacity` bytes with its terminating 0. The device renders
   * zero force until the first write(). */
  palpate_device* (*open)(const char* id, const char* options, char* error, size_t capacity);

  /* Fills the members of `limits`; the caller sets limits->size. */
  int32_t (*limits)(palpate_device* device, palpate_device_limits* limits);

  /* Fills the members of `state` with the newest reading; the caller sets state->size. */
  int32_t (*read)(palpate_device* device, palpate_device_state* state);

  /* Sets the force on the hand, N; the device holds it until the next call. The force is always
   * finite and no larger than max_force. */
  int32_t (*write)(palpate_device* device, const double force[3]);

  /* If `halted` is 1, sets the force to zero and ignores further writes until a call with 0. Any
   * thread. */
  void (*halt)(palpate_device* device, int32_t halted);

  /* Returns a sentence that says why the last call for this device failed. */
  const char* (*last_error)(palpate_device* device);

  /* Sets zero force and frees the device. */
  void (*close)(palpate_device* device);
} palpate_device_plugin;

PALPATE_DEVICE_EXPORT const palpate_device_plugin* palpate_device_plugin_v1(void);
typedef const palpate_device_plugin* (*palpate_device_plugin_function)(void);

#ifdef __cplusplus
}
#endif

#endif
