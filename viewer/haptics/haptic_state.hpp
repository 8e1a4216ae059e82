#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

/// All that one tick knew and did. Goes to other threads by value: picture, recording.
struct HapticState {
  std::uint64_t tick = 0;  ///< counted from 1
  double time = 0;         ///< s, tick * period: not the clock of the wall
  DeviceReading reading;
  /// m, scene frame; the last that was known, always finite
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();
  Touch touch;
  /// N, scene frame: what was written to the device
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  std::uint32_t guards = 0;            ///< Guarded bits
  double passivity = 0;                ///< J, GuardedForce
  std::int32_t model = 0, method = 0;  ///< in use
};

/// What another thread asks of the haptic thread.
struct HapticCommand {
  enum class Kind : std::uint8_t {
    use,      ///< model and method, by number
    release,  ///< end the contact
  } kind = Kind::use;
  std::int32_t model = 0, method = 0;
};

}  // namespace palpate
