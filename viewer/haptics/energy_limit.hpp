#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

/// Bounds the force of a contact so that the hand gets back no more energy than it put in.
///
/// A device holds each force for a period T. A force that passes through another thread begins to
/// act only one or two periods after the reading from which it was computed; D is this delay. A
/// rendered spring therefore pushes harder while the hand moves out than while it moves in: with
/// stiffness K and speed v it creates the power K v^2 (D + T/2). This class keeps two sums, J:
/// - energy: work of the hand against the force that the device held (HeldForces). If the device
///   may have held any of several forces, the one that gave the hand most energy is assumed.
/// - stored: energy that the tissue gives back, from Touch::energy or by integrating the force
///   along the path.
///
/// While the hand moves in, the force equals the tissue's force. While it moves out, the force is
/// the tissue's force at the position predicted for the middle of the time for which the device
/// will hold the force, multiplied by energy / stored. Both sums are predicted for the time when
/// the force begins to act. The energy that the loop created is thus taken back before the hand
/// reaches the undeformed surface. The force falls below the tissue's force by at most `damping` K
/// (D + T/2) v, so it does not jump when the motion reverses. The force is also limited so that the
/// available energy suffices to hold it for a period and then reduce it at the rate max_slew.
///
/// After a tenth of a second at rest a deficit of energy is forgiven. A device rounds positions to
/// multiples of a step, and the position of a hand at rest can flicker between two multiples. A
/// motion outward is therefore taken into account only after two consecutive readings agree on it.
///
/// One thread; real time; deterministic.
class EnergyLimit {
 public:
  /// Number of past ticks whose written forces are kept.
  static constexpr std::uint32_t remembered = 32;

  /// Numbers (N, m, J) above this limit cannot come from a hand. Squares and sums of smaller
  /// numbers do not overflow.
  static constexpr double largest_number = 1e9;

  /// period: s. max_slew: N/s. credit: largest surplus or deficit of energy that is remembered, J.
  EnergyLimit(double period, double max_slew, double credit)
      : period_(period), max_slew_(max_slew), credit_(credit) {}
  void reset() noexcept { *this = EnergyLimit(period_, max_slew_, credit_); }
  /// Forgets the last position and velocity. Call it if the tool jumped or has no position.
  void forgetMotion() noexcept;
  /// Adds the motion that ended at `tool` (m). Call in each tick in which the tool has a position.
  /// rendered: fraction of the raw force that remains after the clamp to max_force.
  void observe(const Eigen::Vector3d& tool, const Touch& touch, double rendered,
               const HeldForces& held, bool fresh) noexcept;
  /// Sets the stored energy, J. A surplus or deficit is remembered, up to the credit.
  void restart(double stored) noexcept;
  /// Shortens `force` (N) if the hand would get back too much energy. Returns whether it did.
  bool bound(Eigen::Vector3d& force, const Eigen::Matrix3d& stiffness) const noexcept;
  /// Records the force that is written to the device, N. Call once per tick.
  void give(const Eigen::Vector3d& force) noexcept;
  /// Returns the work of the hand minus the stored energy, J.
  double passivity() const noexcept { return energy_ - stored_; }

 private:
  struct Outward;

  const Eigen::Vector3d& given(std::uint32_t ticks_ago) const noexcept;
  double work(const Eigen::Vector3d& motion, const HeldForces& held) const noexcept;
  void move(const Eigen::Vector3d& motion, double interval) noexcept;
  void forgiveAtRest(const Eigen::Vector3d& tool, double interval) noexcept;
  Outward outward(const Eigen::Vector3d& direction, double growing) const noexcept;
  double available(const Outward& path) const noexcept;
  double returned(double force, double stiffness, const Outward& path) const noexcept;
  double releasable(double force, const Outward& path) const noexcept;

  double period_, max_slew_, credit_;
  std::array<Eigen::Vector3d, remembered> given_ = [] {
    std::array<Eigen::Vector3d, remembered> none;
    none.fill(Eigen::Vector3d::Zero());
    return none;
  }();
  std::uint32_t tick_ = 0;   ///< number of forces written so far
  std::uint32_t age_ = 0;    ///< number of ticks since the last fresh reading
  bool known_ = false;       ///< whether tool_ is valid
  double delay_ = 0;         ///< time from the last reading until the next force begins to act, s
  double hold_ = 0;          ///< time for which a force is held, s
  double interval_ = 0;      ///< duration of the last motion, s
  double rest_time_ = 0;     ///< time for which the tool has stayed near rest_, s
  double energy_ = 0;        ///< J
  double stored_ = 0;        ///< J
  double touch_energy_ = 0;  ///< energy of the touch at the last reading, J
  double rendered_ = 1;      ///< `rendered` of the last reading, see observe()
  // Motion and raw force at the last reading and the one before; m, m/s, m/s^2, N.
  Eigen::Vector3d tool_ = Eigen::Vector3d::Zero(), rest_ = tool_, velocity_ = tool_,
                  last_velocity_ = tool_, acceleration_ = tool_, last_acceleration_ = tool_,
                  raw_ = tool_;
};

}  // namespace palpate
