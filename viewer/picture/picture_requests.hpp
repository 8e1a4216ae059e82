#pragma once

#include <cstdint>
#include <optional>

#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

/// Requests by the user since the last picture.
struct PictureRequests {
  struct Use {
    std::int32_t model = 0, method = 0;
  };
  std::optional<Use> use;  ///< switch to another dataset or method
  bool release = false;    ///< end the contact
  bool pause = false;      ///< pause or continue; one press
  bool reload = false;     ///< read the datasets again
  bool quit = false;       ///< pressed the key; wantsClose() reports a closed window
  /// Position of the tool by mouse and keys; empty: another device moves it.
  std::optional<MouseTarget> tool;
};

}  // namespace palpate
