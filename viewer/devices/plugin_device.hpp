#pragma once

#include <filesystem>
#include <string>
#include <thread>

#include "viewer/devices/device_exchange.hpp"

namespace palpate {

struct PluginDeviceOptions {
  std::filesystem::path library;
  std::string id = {};       ///< empty: the first device of the plug-in
  std::string options = {};  ///< text for the plug-in alone
  double period = 1e-3;      ///< s, in which it is read and written
};

/// A device of a plug-in (palpate_device.h): a shared library that is loaded at run time.
///
/// The plug-in may wait for its device, so it has a thread of its own and the haptic thread sees
/// the newest reading. A plug-in that hangs is lost after 50 ms, and halted by
/// HapticDevice::halt(). One that still hangs two seconds after the end of this object is left
/// behind, loaded.
class PluginDevice : public ThreadedDevice {
 public:
  /// Loads and opens. Error (bad input) that names the file when it is no library, exports no
  /// palpate_device_plugin_v1, is of another version of the interface, or lacks a function; Error
  /// with the plug-in's own words when the device cannot be opened.
  explicit PluginDevice(const PluginDeviceOptions& options);
  ~PluginDevice() override;

  void halt() noexcept override;
  std::string name() const override;
  std::string askForRealTime() override;

 private:
  class Session;
  std::shared_ptr<Session> session_;  ///< shared with its thread, which may outlive this object
  std::thread thread_;
};

}  // namespace palpate
