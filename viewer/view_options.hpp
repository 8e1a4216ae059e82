#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/scene.hpp"

namespace palpate {

/// What `palpate view` was asked for.
struct ViewOptions {
  std::vector<std::filesystem::path> datasets;  ///< at least one; the first is felt first
  std::string device = "virtual";               ///< a word of device_choice.hpp
  std::string profile;                          ///< of deviceProfiles(); empty: the device's own
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

}  // namespace palpate
