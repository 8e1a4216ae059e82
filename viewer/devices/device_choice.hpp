#pragma once

#include <memory>
#include <string>

#include "common/keys/key_options.hpp"
#include "viewer/devices/touch_path.hpp"
#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

class HapticModel;

/// The loop and the body for which a device is opened.
struct DeviceContext {
  /// The body. Its surface determines the default path of the virtual hand, and the mouse touches
  /// it in the picture. If null, neither of these two devices can be opened.
  const HapticModel* model = nullptr;
  double period = 1e-3;  ///< s; period of the loop that reads the device
  /// Limits for devices that have none of their own (virtual hand, mouse). A network device uses
  /// them until it reports its own limits.
  DeviceProfile profile = device_profiles.front();
  KeyOptions keys = {};                   ///< key for a device on the network
  double hand_speed = usual_slide_speed;  ///< slide speed of the virtual hand (touchPath), m/s
  bool real_time = false;                 ///< see NetworkDeviceOptions::real_time
};

/// Defaults of --device: the first for a window that runs in real time, the second for all other
/// runs.
inline constexpr const char *window_device = "mouse", *default_device = "virtual";

/// Returns the words that --device accepts, as text for users. Without a body (`with_body` false)
/// the list leaves out the devices that need one.
std::string deviceHelp(bool with_body);

/// Checks a word of --device without opening the device; only openDevice() finds out whether the
/// device is available. Throws Error (bad input), which lists the valid words, if the word is
/// unknown or a required part of it is missing.
void checkDeviceWord(const std::string& word);

/// Opens a device by its word:
///   virtual             a scripted hand that explores the touchable surface (touchPath)
///   virtual:FILE        a hand that follows the path in FILE (readHandPath)
///   mouse               the mouse and keys of the picture (MouseDevice)
///   replay:FILE         a recorded run
///   tcp://HOST:PORT     a device that `palpate device` lends (also ipc://PATH)
///   haply, haply:ID     a Haply Inverse3 through its service on this machine
///   plugin:LIB[:ID[:OPTIONS]]  a device of a plug-in (palpate_device.h); LIB has no colon
/// Throws Error (bad input) as checkDeviceWord() does, and the errors of the device's constructor.
std::unique_ptr<HapticDevice> openDevice(const std::string& word, const DeviceContext& context);

/// Returns a profile with the smaller force, the smaller stiffness and the smaller workspace radius
/// of the two, and the name of the first.
DeviceProfile smallerOf(const DeviceProfile& first, const DeviceProfile& second);
/// Returns a warning, as a sentence, if no haptic device has limits like these: more than 100 N, or
/// a workspace radius below 5 mm or above 2 m. Otherwise returns an empty string.
std::string doubtsOf(const DeviceProfile& profile);

}  // namespace palpate
