#pragma once

#include <iosfwd>
#include <optional>
#include <vector>

#include "common/keys/key_options.hpp"
#include "common/scene/scene.hpp"

namespace palpate {

/// Options of `palpate view`.
struct ViewOptions {
  std::vector<std::filesystem::path> datasets;  ///< at least one; starts with the first
  std::string device;                           ///< a word of device_choice.hpp
  KeyOptions keys = {};                         ///< for a device on the network
  std::string profile;  ///< name in device_profiles; empty: the device's own
  std::string method = "potential";
  std::optional<ContactMode> contact;  ///< nothing: the scene's
  double friction = 0.2;
  double reach = 0;    ///< m, TouchSurface
  double rate = 1000;  ///< Hz
  /// s of haptic time; 0: until the window closes, the device ends or a signal comes
  double duration = 0;
  bool headless = false;
  bool fast = false;  ///< ticks as fast as possible, without a clock
  bool real_time = false;
  std::filesystem::path record;      ///< empty: no recording
  std::filesystem::path screenshot;  ///< empty: none
  std::filesystem::path video;       ///< directory; empty: none
  bool json = false;
};

/// Runs `palpate view`: the haptic client, on this thread, which also draws. Ends when the window
/// is closed, the duration is over, a replay ends, or a signal comes; then prints the loop's
/// statistics. Throws Error (bad input) if the recording would replace a dataset, and the errors of
/// datasets, window and device.
ExitCode view(const ViewOptions& options, std::ostream& output);

/// Returns the verb `view` of palpate-viewer, the haptic client. Throws Error (bad input) for wrong
/// options, before it opens the device, and Error if a picture is wanted but there is no display.
Verb viewVerb();

}  // namespace palpate
