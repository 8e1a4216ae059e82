#pragma once

#include <memory>
#include <string>

#include "common/keys/key_options.hpp"
#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

class HapticModel;

/// The loop and the body that a device is opened for.
struct DeviceContext {
  /// The body: gives the virtual hand its default path and the mouse its target. If null, neither
  /// of the two can be opened.
  const HapticModel* model = nullptr;
  double period = 1e-3;  ///< s; period of the loop that reads the device
  /// Limits of devices without their own (virtual hand, mouse), and of a network device until it
  /// reports its own.
  DeviceProfile profile = device_profiles.front();
  KeyOptions keys = {};    ///< for a device on the network
  bool real_time = false;  ///< see NetworkDeviceOptions::real_time
};

/// Defaults of --device: for a window that runs in real time, and for other runs.
inline constexpr const char *window_device = "mouse", *default_device = "virtual";

/// Returns the valid words for --device, as text for users. Without a body there are fewer.
std::string deviceHelp(bool with_body);

/// Throws Error (bad input), listing the valid words, if no device of a body has this word or if a
/// part of it is missing. Opens nothing; openDevice() finds out whether the device is available.
void checkDeviceWord(const std::string& word);

/// Opens a device by its word:
///   virtual             a scripted hand that explores the touchable surface (touchPath)
///   virtual:FILE        a hand that follows the path in FILE (readHandPath)
///   mouse               the mouse and keys of the picture (MouseDevice)
///   replay:FILE         a recorded run
///   tcp://HOST:PORT     a device that `palpate device` lends (also ipc://PATH)
///   haply, haply:ID     a Haply Inverse3 through its service on this machine
///   plugin:LIB[:ID[:OPTIONS]]  a device of a plug-in (palpate_device.h); LIB without a colon
/// Throws Error (bad input) as checkDeviceWord() does, and the errors of the device's constructor.
std::unique_ptr<HapticDevice> openDevice(const std::string& word, const DeviceContext& context);

/// Returns the smaller force, stiffness and workspace radius of two profiles, with the name of the
/// first.
DeviceProfile smallerOf(const DeviceProfile& first, const DeviceProfile& second);
/// Returns a warning, as a sentence, if the limits fit no haptic device: more than 100 N, or a
/// workspace radius below 5 mm or above 2 m. Usually empty.
std::string doubtsOf(const DeviceProfile& profile);

}  // namespace palpate
