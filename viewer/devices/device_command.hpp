#pragma once

#include <string>

#include "common/keys/key_options.hpp"

namespace palpate {

struct DeviceCommandOptions {
  std::string endpoint;          ///< where to listen
  std::string device = "haply";  ///< openDevice()
  double rate = 1000;            ///< Hz
  KeyOptions keys = {};
};

/// `palpate device`: lends a device of this machine to a simulator on another (DeviceServer), until
/// it is interrupted. Error (bad input) for a wrong word or endpoint, or keys that cannot be read.
ExitCode serveDevice(const DeviceCommandOptions& options);

/// The verb `device` of palpate-viewer.
Verb deviceVerb();

}  // namespace palpate
