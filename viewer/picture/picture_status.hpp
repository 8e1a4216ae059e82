#pragma once

#include <string>

#include "common/scene/scene.hpp"
#include "viewer/haptics/loop_statistics.hpp"

namespace palpate {

/// What a picture shows beside the state of the tick.
struct PictureStatus {
  std::string device = {};   ///< HapticDevice::name()
  std::string trouble = {};  ///< of device and loop, sentences; shown in red; empty: none
  std::string notice = {};   ///< anything else to say, shown in blue; empty: nothing
  double max_force = 3.3;    ///< N, of the device: no arrow is longer than its
  bool mouse = false;        ///< the device is the mouse of the picture
  ContactMode contact = ContactMode::unilateral;  ///< of the loop
  bool paused = false;
  bool recording = false;
  LoopStatistics loop = {};  ///< of the loop so far; rate 0: no loop runs
};

}  // namespace palpate
