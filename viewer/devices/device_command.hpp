#pragma once

#include <string>

#include "common/base/program.hpp"

namespace palpate {

struct DeviceCommandOptions {
  std::string endpoint;          ///< where to listen
  std::string device = "haply";  ///< openDevice()
  double rate = 1000;            ///< Hz
  bool insecure = false;         ///< listen beyond this machine
};

/// `palpate device`: lends a device of this machine to a simulator on another (DeviceServer), until
/// it is interrupted. Error (bad input) for a wrong word or endpoint, or one beyond this machine
/// without `insecure`.
ExitCode serveDevice(const DeviceCommandOptions& options);

/// The verb `device` of palpate-viewer.
Verb deviceVerb();

}  // namespace palpate
