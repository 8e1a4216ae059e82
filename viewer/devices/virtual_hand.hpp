#pragma once

#include <atomic>
#include <cstdint>

#include "viewer/devices/hand_path.hpp"
#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

/// The default device: an operator who follows a path and gives way to the force,
///   m x'' = k (target - x) + b (target' - x') + F,
/// integrated semi-implicitly (Euler) with fixed substeps. Knows no clock: every read() is one
/// period later than the one before, so the same forces give the same positions to the last bit.
/// Lives in the scene.
///
/// The hand is a loose grasp of a stylus: the identified mass, stiffness and damping of hands and
/// fingers on a tool lie around these and vary several-fold with the grasp (Hajian and Howe 1997,
/// Identification of the mechanical impedance at the human finger tip; Kuchenbecker, Park and
/// Niemeyer 2003, Characterizing the human wrist for improved haptic interaction; Speich, Shao and
/// Goldfarb 2005, Modeling the human hand as it interacts with a telemanipulation system). Damping
/// ratio 0.52, natural frequency 8 Hz.
class VirtualHand : public HapticDevice {
 public:
  static constexpr double mass = 0.15;  ///< kg, of hand and tool
  /// N/m, with which the hand holds the tool to its target
  static constexpr double stiffness = 400;
  static constexpr double damping = 8;  ///< N s/m

  /// period: s, that passes with every read(). Error (bad input) for one that is not positive,
  /// or too long for a stable integration.
  VirtualHand(HandPath path, double period, const DeviceProfile& profile);

  /// The first reading is the beginning of the path, at rest.
  DeviceReading read() noexcept override;
  void write(const Eigen::Vector3d& force) noexcept override;
  void halt() noexcept override { halted_ = true; }
  void resume() noexcept override { halted_ = false; }
  DeviceProfile profile() const override { return profile_; }
  bool livesInScene() const override { return true; }
  bool hasButtons() const override { return true; }
  std::string name() const override { return "virtual hand"; }

  const HandPath& path() const { return path_; }

 private:
  void advance() noexcept;

  HandPath path_;
  double period_;
  DeviceProfile profile_;
  std::atomic<bool> halted_ = false;
  std::uint64_t reads_ = 0;
  Eigen::Vector3d position_, velocity_ = Eigen::Vector3d::Zero(), force_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate
