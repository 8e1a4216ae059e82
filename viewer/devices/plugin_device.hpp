#pragma once

#include <filesystem>
#include <string>
#include <thread>

#include "viewer/devices/device_exchange.hpp"

namespace palpate {

struct PluginDeviceOptions {
  std::filesystem::path library;
  std::string id = {};       ///< empty: the plug-in's first device
  std::string options = {};  ///< text for the plug-in
  double period = 1e-3;      ///< time between two reads, s
};

/// A device of a plug-in (palpate_device.h), a shared library that is loaded at run time.
///
/// A plug-in may wait for its device, so it runs in its own thread, and the haptic thread gets the
/// newest reading. If the plug-in hangs, the device counts as lost after 50 ms, and
/// HapticDevice::halt() halts it. If the plug-in still hangs two seconds after the destructor
/// started, the destructor leaves the thread running and the library loaded.
class PluginDevice : public ThreadedDevice {
 public:
  /// Loads the library and opens the device. Throws Error (bad input) with the name of the file if
  /// the file is not a library, does not export palpate_device_plugin_v1, has another interface
  /// version, or lacks a function. Throws Error with the plug-in's message if the device cannot be
  /// opened.
  explicit PluginDevice(const PluginDeviceOptions& options);
  ~PluginDevice() override;

  void halt() noexcept override;
  std::string name() const override;

 private:
  class Session;
  pthread_t thread() override { return thread_.native_handle(); }
  std::shared_ptr<Session> session_;  ///< shared with the plug-in's thread, which may outlive this
                                      ///< object
  std::thread thread_;
};

}  // namespace palpate
