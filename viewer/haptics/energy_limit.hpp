#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

/// Bounds the force of a contact so that the hand gets back no more energy than it put in.
///
/// A device holds each force for a period, and a force that another thread passes on begins to act
/// a period or two after its reading. A spring therefore pushes harder on the way out than on the
/// way in. With stiffness K, speed v and delay D it creates the power K v^2 (D + T/2). This class
/// keeps two sums, J:
/// - energy: work of the hand against the force that the device held (HeldForces). If several
///   forces are possible, it uses the worst case.
/// - stored: energy that the tissue gives back, from Touch::energy or by integration along the
///   path.
///
/// On the way in the force equals the tissue's force. On the way out it is the tissue's force at
/// the middle of its period, multiplied by energy / stored, both predicted for the time when the
/// force begins to act. This spreads the energy that the loop created over the rest of the way. The
/// force falls below the tissue's force by at most `damping` K (D + T/2) v, so it does not jump
/// when the motion reverses. The force is also bounded so that holding it for a period and then
/// reducing it by max_slew costs no more than the available energy.
///
/// A deficit is forgiven after a tenth of a second at rest: a device counts in steps, and the
/// flicker between two steps is not work. A motion outward counts only after two consecutive
/// readings agree on it.
///
/// One thread; real time; deterministic.
class EnergyLimit {
 public:
  /// Number of past ticks with a stored force.
  static constexpr std::uint32_t remembered = 32;

  /// Larger numbers (N, m, J) are beyond any hand; squares and sums of numbers up to this one do
  /// not overflow.
  static constexpr double largest_number = 1e9;

  /// period: s; max_slew: N/s; credit: largest surplus or deficit that is carried along, J.
  EnergyLimit(double period, double max_slew, double credit)
      : period_(period), max_slew_(max_slew), credit_(credit) {}
  void reset() noexcept { *this = EnergyLimit(period_, max_slew_, credit_); }
  /// Forgets the last position and velocity: the tool jumped or has no position.
  void forgetMotion() noexcept;
  /// Adds the motion that ended at `tool` (m). Call in each tick with a position. rendered: share
  /// of the force that passes the clamp.
  void observe(const Eigen::Vector3d& tool, const Touch& touch, double rendered,
               const HeldForces& held, bool fresh) noexcept;
  /// Sets the stored energy, J. Keeps a surplus or deficit up to the credit.
  void restart(double stored) noexcept;
  /// Shortens `force` (N) if necessary; returns whether it did.
  bool bound(Eigen::Vector3d& force, const Eigen::Matrix3d& stiffness) const noexcept;
  /// Stores the force that is written, N. Call once per tick.
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
  std::uint32_t tick_ = 0;   ///< number of the next force in given_
  std::uint32_t age_ = 0;    ///< ticks since the last reading
  bool known_ = false;       ///< tool_ is the last position of the tool
  double delay_ = 0;         ///< from the last reading to its force, s
  double hold_ = 0;          ///< time for which a force is held, s
  double interval_ = 0;      ///< duration of the last motion, s
  double rest_time_ = 0;     ///< time that the tool has stayed near rest_, s
  double energy_ = 0;        ///< J
  double stored_ = 0;        ///< J
  double touch_energy_ = 0;  ///< at the last reading, J
  double rendered_ = 1;      ///< share at the last reading
  // From the last reading and the one before; m, m/s, m/s^2, N.
  Eigen::Vector3d tool_ = Eigen::Vector3d::Zero(), rest_ = tool_, velocity_ = tool_,
                  last_velocity_ = tool_, acceleration_ = tool_, last_acceleration_ = tool_,
                  raw_ = tool_;
};

}  // namespace palpate
