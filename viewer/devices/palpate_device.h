/* A haptic device as a plug-in of Palpate: a shared library that exports one function,
 *
 *     const palpate_device_plugin* palpate_device_plugin_v1(void);
 *
 * C99 and C++. See docs/devices.md, and deploy/examples/device-plugin for a complete plug-in.
 *
 * Units: metres, newtons, seconds. Frame: right-handed, x to the right, y up, z toward the
 * operator, origin in the middle of the workspace. A device with limits.lives_in_scene uses the
 * frame of the scene instead.
 *
 * Threads: Palpate creates one thread per open device. Only this thread calls read() and write(),
 * one after the other, once per period. Both may wait briefly for the device. After 50 ms without a
 * reading the device counts as lost and is halted; halt(0) follows after the next write(). open(),
 * limits(), close() and last_error() are called by that thread, or while it does not run. halt()
 * may be called by any thread at any time, even while read() or write() waits.
 *
 * Lifetimes: the table and its strings are valid while the library is loaded, an open device from
 * open() to close(), and the text of last_error() until the next call for that device. No exception
 * may cross this boundary.
 *
 * Sizes: every struct starts with its size in bytes. Its writer stays within the given size, so
 * that later versions can append members. Nothing else about version 1 will change.
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
  uint32_t lives_in_scene; /* 0 or 1: positions are in the frame of the scene */
  uint32_t reserved;
  double max_force;        /* N, > 0; no larger force is written */
  double max_stiffness;    /* N/m, > 0; largest that the closed loop renders stably */
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

  /* Writes the id of device number `index` (from 0) and a 0 into `id`. Returns FAILED after the
   * last device. */
  int32_t (*enumerate)(uint32_t index, char* id, size_t capacity);

  /* Opens the device with this id; an empty id takes the first. `options` is text for the plug-in,
   * may be empty. On failure returns NULL and writes the reason to `error` (a sentence, at most
   * `capacity` bytes including its 0). The force is zero until the first write(). */
  palpate_device* (*open)(const char* id, const char* options, char* error, size_t capacity);

  /* Fills the members of `limits`; the caller sets limits->size. */
  int32_t (*limits)(palpate_device* device, palpate_device_limits* limits);

  /* Fills in the newest state; the caller sets state->size. */
  int32_t (*read)(palpate_device* device, palpate_device_state* state);

  /* Sets the force on the hand, N, until the next call. Always finite and within max_force. */
  int32_t (*write)(palpate_device* device, const double force[3]);

  /* With halted 1, sets the force to zero and ignores further writes until a call with 0. Any
   * thread. */
  void (*halt)(palpate_device* device, int32_t halted);

  /* Returns the reason why the last call for this device failed, as a sentence. */
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
