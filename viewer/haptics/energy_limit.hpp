#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

/// Bounds the force of a contact so that the hand gets back no more energy than it put in.
///
/// A device holds each force for a period, and a force that a thread passes on begins to act a
/// period or two after the reading that it answers. So a spring pushes harder on the way out than
/// it did on the way in: with the stiffness K, the speed v and the delay D it creates the power
/// K v^2 (D + T/2). This class keeps two sums, J:
///   energy: the work of the hand against the force that was really held (HeldForces), the worst of
///     those that may have been;
///   stored: what the tissue gives back, by Touch::energy, or else by the path.
/// On the way out the force is multiplied by energy / stored, both as they will be when it begins
/// to act, and is that of the middle of its period: energy that the loop created is spread over the
/// way that is left. On the way in the force is that of the tissue. The force falls below that of
/// the tissue by at most `damping` K (D + T/2) v, so that it does not jump where the motion turns.
/// A force that the slew limit could not take back in time is bounded too: holding it for a period
/// and then letting it fall by max_slew may not cost more than there is.
///
/// At rest for a tenth of a second what is missing is forgiven: a device counts in steps, and the
/// work of its flicker is none. A motion outward counts when two readings in turn say so.
///
/// One thread; real time; a function of its inputs alone.
class EnergyLimit {
 public:
  /// Ticks that it remembers forces for.
  static constexpr std::uint32_t remembered = 32;

  /// Nothing a hand can feel or reach (N, m, J); squares and sums of such numbers do not overflow.
  static constexpr double largest_number = 1e9;

  /// period: s; max_slew: N/s; credit: J, dissipated or owed, that is remembered at most.
  EnergyLimit(double period, double max_slew, double credit)
      : period_(period), max_slew_(max_slew), credit_(credit) {}
  void reset() noexcept { *this = EnergyLimit(period_, max_slew_, credit_); }
  /// The tool is not where it was by a motion: a jump, or no position at all.
  void forgetMotion() noexcept;
  /// Each tick with a position: the motion that ended with it. tool: m. rendered: the share of the
  /// force that the clamp lets through.
  void observe(const Eigen::Vector3d& tool, const Touch& touch, double rendered,
               const HeldForces& held, bool fresh) noexcept;
  /// What is stored is this, J; of what was missing or left over, at most the credit is kept.
  void restart(double stored) noexcept;
  /// force: N, shortened where it must be. Whether it was.
  bool bound(Eigen::Vector3d& force, const Eigen::Matrix3d& stiffness) const noexcept;
  /// Each tick: the force that is written, N.
  void give(const Eigen::Vector3d& force) noexcept;
  /// J, put in by the hand less what is stored.
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
  std::uint32_t tick_ = 0;   ///< of the next force in given_
  std::uint32_t age_ = 0;    ///< ticks since the newest reading
  bool known_ = false;       ///< tool_ is where the tool was
  double delay_ = 0;         ///< s, from the newest reading to the force that will answer it
  double hold_ = 0;          ///< s, that a force is held
  double interval_ = 0;      ///< s, of the last motion
  double rest_time_ = 0;     ///< s, that the tool has been near rest_
  double energy_ = 0;        ///< J
  double stored_ = 0;        ///< J
  double touch_energy_ = 0;  ///< J, of the last reading
  double rendered_ = 1;      ///< of the last reading
  // Of the last reading and the one before; m, m/s, m/s^2, N.
  Eigen::Vector3d tool_ = Eigen::Vector3d::Zero(), rest_ = tool_, velocity_ = tool_,
                  last_velocity_ = tool_, acceleration_ = tool_, last_acceleration_ = tool_,
                  raw_ = tool_;
};

}  // namespace palpate
