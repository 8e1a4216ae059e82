#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/scene/scene.hpp"
#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/loop_statistics.hpp"

namespace palpate {

/// Contents of a frame in addition to the state of the tick.
struct PictureStatus {
  std::string device = {};   ///< HapticDevice::name()
  std::string trouble = {};  ///< sentences about problems of device and loop, shown in red; empty
                             ///< if there are none
  std::string notice = {};   ///< any other message, shown in blue; empty if there is none
  double max_force = 3.3;    ///< largest force of the device, N; upper limit of the arrow's scale
  bool mouse = false;        ///< the device is the mouse of the picture
  ContactMode contact = ContactMode::unilateral;  ///< mode of the loop
  bool paused = false;
  bool recording = false;
  LoopStatistics loop = {};  ///< statistics of the loop so far; rate is 0 if no loop runs
};

/// Requests that the user made since the last frame.
struct PictureRequests {
  struct Use {
    std::int32_t model = 0, method = 0;
  };
  std::optional<Use> use;  ///< switch to another dataset or method
  bool release = false;    ///< end the contact
  bool hold = false;       ///< leave a second finger here, or let it go
  bool pause = false;      ///< pause, or continue after a pause
  bool reload = false;     ///< read the datasets again
  bool quit = false;       ///< the quit key was pressed; wantsClose() tells whether the window was
                           ///< closed
  /// Position to which mouse and keys move the tool; empty if another device moves it.
  std::optional<MouseTarget> tool;
};

}  // namespace palpate
