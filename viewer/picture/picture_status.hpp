#pragma once

#include <string>

#include "common/scene/scene.hpp"
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

}  // namespace palpate
