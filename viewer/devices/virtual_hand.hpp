#pragma once

#include <atomic>
#include <cstdint>

#include "viewer/devices/hand_path.hpp"
#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

/// The default device: a simulated operator. A spring and a damper pull the hand toward a target
/// that moves along a path, and the hand yields to the force F of the device:
///   m x'' = k (target - x) + b (target' - x') + F.
/// The motion is integrated by semi-implicit Euler with fixed substeps. Each read() advances the
/// time by one period. No clock is involved, so the same forces give bitwise identical positions.
/// Positions are in the scene's frame.
///
/// The constants describe a loose grasp of a stylus: damping ratio 0.52, natural frequency 8 Hz.
/// Published values of the mass, stiffness and damping of hands and fingers on a tool lie around
/// these constants. They vary several-fold with the grasp:
/// - Hajian and Howe 1997, Identification of the mechanical impedance at the human finger tip;
/// - Kuchenbecker, Park and Niemeyer 2003, Characterizing the human wrist for improved haptic
///   interaction;
/// - Speich, Shao and Goldfarb 2005, Modeling the human hand as it interacts with a
///   telemanipulation system.
class VirtualHand : public HapticDevice {
 public:
  static constexpr double mass = 0.15;  ///< kg, hand and tool
  /// N/m; stiffness with which the hand holds the tool at its target
  static constexpr double stiffness = 400;
  static constexpr double damping = 8;  ///< N s/m

  /// `period` is the time between two calls of read(), s. Throws Error (bad input) if `period` is
  /// not positive, or too long for a stable integration.
  VirtualHand(HandPath path, double period, const DeviceProfile& profile);

  /// The first call returns the start of the path, at rest.
  DeviceReading read() noexcept override;
  void write(const Eigen::Vector3d& force) noexcept override;
  void halt() noexcept override { halted_ = true; }
  void resume() noexcept override { halted_ = false; }
  std::string name() const override { return "virtual hand"; }

  const HandPath& path() const { return path_; }

 private:
  void advance() noexcept;

  HandPath path_;
  double period_;
  std::atomic<bool> halted_ = false;
  std::uint64_t reads_ = 0;
  Eigen::Vector3d position_, velocity_ = Eigen::Vector3d::Zero(), force_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate
