#pragma once

#include <iosfwd>
#include <memory>
#include <optional>
#include <vector>

#include "common/keys/key_options.hpp"
#include "common/scene/scene.hpp"
#include "viewer/devices/touch_path.hpp"

namespace palpate {

/// Options of `palpate view`.
struct ViewOptions {
  /// At least one; the first is shown at the start. The first may also be a scene (SCENE.toml),
  /// which the live solver solves near the hand.
  std::vector<std::filesystem::path> datasets;
  std::string device;           ///< a word of device_choice.hpp
  KeyOptions keys = {};         ///< for a network device
  std::string profile;          ///< a name in device_profiles; empty: the device's own limits
  std::filesystem::path live;   ///< scene of the first dataset; empty: no live solver
  std::string follower;         ///< endpoint of a live solver; empty: one is started
  std::filesystem::path hold;   ///< recording that moves a second finger; empty: none
  std::filesystem::path build;  ///< dataset of the scene to build meanwhile; empty: none
  std::string method = "potential";
  std::optional<ContactMode> contact;  ///< nullopt: as the scene requests
  double friction = 0.2;
  double reach = 0;                       ///< m; passed to TouchSurface
  double rate = 1000;                     ///< Hz
  double hand_speed = usual_slide_speed;  ///< of the virtual hand, m/s
  /// Length of the run, s of haptic time. If it is 0, the run lasts until the window is closed, the
  /// device ends or a signal arrives.
  double duration = 0;
  bool headless = false;
  bool fast = false;  ///< ticks as fast as possible, without a clock
  bool real_time = false;
  std::filesystem::path record;      ///< empty: no recording
  std::filesystem::path screenshot;  ///< empty: none
  std::filesystem::path video;       ///< directory; empty: none
  bool json = false;
};

/// Runs `palpate view`, the haptic client. It runs on the calling thread, which also draws. It ends
/// when the window is closed, the duration is over, a replay ends, or a signal arrives; it then
/// prints the statistics of the loop. Throws Error (bad input) if the recording would replace a
/// dataset, and the errors of datasets, window and device.
ExitCode view(const ViewOptions& options, std::ostream& output);

/// Declares the options of `palpate view`, except the datasets and --live. Returns the function
/// that completes and checks `options` after parsing; it throws Error (bad input).
std::function<void()> addViewOptions(CLI::App& app, const std::shared_ptr<ViewOptions>& options);

/// The verb `view` of palpate-viewer, the haptic client. The verb throws Error (bad input) for
/// wrong options before it opens the device, and Error if a picture is needed but there is no
/// display.
extern const Verb view_verb;

}  // namespace palpate
