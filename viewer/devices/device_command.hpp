#pragma once

#include <string>

#include "common/keys/key_options.hpp"

namespace palpate {

struct DeviceCommandOptions {
  std::string endpoint;          ///< address to listen on
  std::string device = "haply";  ///< word for openDevice()
  double rate = 1000;            ///< Hz
  KeyOptions keys = {};

  void addTo(CLI::App& app);  ///< declares the options of the verb
};

/// Runs `palpate device`: lends a local device to a simulator on another machine (DeviceServer)
/// until interrupted. Throws Error (bad input) for an invalid word or endpoint, or unreadable keys.
ExitCode serveDevice(const DeviceCommandOptions& options);

/// The verb `device` of palpate-viewer.
extern const Verb device_verb;

}  // namespace palpate
