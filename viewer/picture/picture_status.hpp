#pragma once

#include <string>

#include "common/scene/scene.hpp"
#include "viewer/haptics/loop_statistics.hpp"

namespace palpate {

/// Contents of a picture beyond the state of the tick.
struct PictureStatus {
  std::string device = {};   ///< HapticDevice::name()
  std::string trouble = {};  ///< sentences about device and loop, in red; empty: none
  std::string notice = {};   ///< any other message, in blue; empty: none
  double max_force = 3.3;    ///< of the device, N; its arrow is the longest
  bool mouse = false;        ///< the device is the mouse of the picture
  ContactMode contact = ContactMode::unilateral;  ///< mode of the loop
  bool paused = false;
  bool recording = false;
  LoopStatistics loop = {};  ///< of the loop so far; rate 0: no loop runs
};

}  // namespace palpate
