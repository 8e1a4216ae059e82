#pragma once

#include <iosfwd>
#include <optional>
#include <vector>

#include "common/keys/key_options.hpp"
#include "common/scene/scene.hpp"

namespace palpate {

/// What `palpate view` was asked for.
struct ViewOptions {
  std::vector<std::filesystem::path> datasets;  ///< at least one; the first is felt first
  std::string device;                           ///< a word of device_choice.hpp
  KeyOptions keys = {};                         ///< for a device on the network
  std::string profile;                          ///< of device_profiles; empty: the device's own
  std::string method = "potential";
  std::optional<ContactMode> contact;  ///< none: what the scene says
  double friction = 0.2;
  double reach = 0;    ///< m, TouchSurface
  double rate = 1000;  ///< Hz
  /// s of haptic time; 0: until the window is closed, the device ends or a signal comes
  double duration = 0;
  bool headless = false;
  bool fast = false;  ///< no clock: tick after tick
  bool real_time = false;
  std::filesystem::path record;      ///< empty: nothing is recorded
  std::filesystem::path screenshot;  ///< empty: none
  std::filesystem::path video;       ///< directory; empty: none
  bool json = false;
};

/// `palpate view`: runs the haptic client in this thread, which draws, until the window is closed,
/// the duration is over, a replay has ended, or a signal came; then prints what the loop measured.
/// Error (bad input) when the recording would replace a dataset. Errors of datasets, window and
/// device name what could not be had.
ExitCode view(const ViewOptions& options, std::ostream& output);

/// The verb `view` of palpate-viewer: the haptic client. Feels the first dataset through a device
/// until the end, then prints what the loop measured on standard output. Error (bad input) for
/// wrong options, before the device is touched; Error when there is no display and a picture is
/// wanted.
Verb viewVerb();

}  // namespace palpate
