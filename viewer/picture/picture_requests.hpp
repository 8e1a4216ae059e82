#pragma once

#include <cstdint>
#include <optional>

#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

/// What the person at the picture asked for since the last one.
struct PictureRequests {
  struct Use {
    std::int32_t model = 0, method = 0;
  };
  std::optional<Use> use;  ///< another dataset or method
  bool release = false;    ///< let go
  bool pause = false;      ///< stop, or go on: pressed once
  bool reload = false;     ///< read the datasets again
  bool quit = false;       ///< pressed the key for it; closing the window shows in wantsClose()
  /// Where mouse and keys have the tool; none: another device has it.
  std::optional<MouseTarget> tool;
};

}  // namespace palpate
