#pragma once

#include <memory>
#include <string>

#include "common/keys/key_options.hpp"
#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

class HapticModel;

/// What a device is opened for.
struct DeviceContext {
  /// What is touched: gives the virtual hand its default path and the mouse its place. May be null;
  /// then those two cannot be had.
  const HapticModel* model = nullptr;
  double period = 1e-3;  ///< s, of the loop that reads the device
  /// Of devices that have no limits of their own: virtual hand, mouse; and of a network device
  /// until it told its own.
  DeviceProfile profile = device_profiles.front();
  KeyOptions keys = {};    ///< for a device on the network
  bool real_time = false;  ///< as NetworkDeviceOptions::real_time
};

/// The word of --device when there is none: in a window that follows the clock, and else.
inline constexpr const char *window_device = "mouse", *default_device = "virtual";

/// The words that --device can be, for people; without a body there are fewer.
std::string deviceHelp(bool with_body);

/// Error (bad input) for a word that no device of a body has, which lists them, or that lacks a
/// part. Opens
/// nothing: whether the device is there shows in openDevice().
void checkDeviceWord(const std::string& word);

/// A device by its word:
///   virtual             a scripted hand that explores what can be touched (touchPath)
///   virtual:FILE        one that follows the path in FILE (readHandPath)
///   mouse               the mouse and the keys of the picture (MouseDevice)
///   replay:FILE         a recorded run
///   tcp://HOST:PORT     a device that `palpate device` lends (also ipc://PATH)
///   haply, haply:ID     a Haply Inverse3 through its service on this machine
///   plugin:LIB[:ID[:OPTIONS]]  a device of a plug-in (palpate_device.h); LIB without a colon
/// Error (bad input) as of checkDeviceWord(); else what the device's constructor throws.
std::unique_ptr<HapticDevice> openDevice(const std::string& word, const DeviceContext& context);

/// The smaller force, stiffness and workspace of two; the name of the first.
DeviceProfile smallerOf(const DeviceProfile& first, const DeviceProfile& second);
/// What no haptic device has, as a sentence: more than 100 N, or a workspace of less than 5 mm or
/// more than 2 m. Empty as a rule.
std::string doubtsOf(const DeviceProfile& profile);

}  // namespace palpate
