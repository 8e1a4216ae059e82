#pragma once

#include <cstdint>
#include <optional>

#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

/// Requests that the user made since the last frame.
struct PictureRequests {
  struct Use {
    std::int32_t model = 0, method = 0;
  };
  std::optional<Use> use;  ///< switch to another dataset or method
  bool release = false;    ///< end the contact
  bool pause = false;      ///< pause, or continue after a pause
  bool reload = false;     ///< read the datasets again
  bool quit = false;       ///< the quit key was pressed; wantsClose() tells whether the window was
                           ///< closed
  /// Position to which mouse and keys move the tool; empty if another device moves it.
  std::optional<MouseTarget> tool;
};

}  // namespace palpate
