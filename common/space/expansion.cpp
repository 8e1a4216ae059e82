#include "common/space/expansion.hpp"

namespace palpate {
namespace {

/// Returns v^T slope_k v for each axis k.
Eigen::Vector3d twice(const SymmetricSlope& slope, const Eigen::Vector3d& v) {
  Eigen::Matrix<double, 6, 1> products;
  products << v[0] * v[0], 2 * v[0] * v[1], 2 * v[0] * v[2], v[1] * v[1], 2 * v[1] * v[2],
      v[2] * v[2];
  return slope.transpose() * products;
}

/// Adds the terms of a hold that has moved to `hold`.
void addHold(const Held& held, const Eigen::Vector3d& ds, const Eigen::Vector3d& dp,
             const Hold& hold, Expansion::Sample& sample) {
  Vector6d moved, hand;
  moved << hold.displacement - held.at.displacement, hold.place - held.at.place;
  hand << dp, ds;
  const Vector6d on_hand = held.hand_by_hold * moved, of_hold = held.stiffness * moved;
  sample.energy -= (held.force + 0.5 * of_hold).dot(moved) + on_hand.dot(hand);
  sample.force += on_hand.head<3>();
  sample.drive += on_hand.tail<3>();
  const Eigen::Vector3d change = (of_hold + held.hand_by_hold.transpose() * hand).head<3>();
  sample.hold_force = held.force.head<3>() + change;
  sample.last_terms += on_hand.head<3>().norm();
  sample.hold_last_terms = change.norm();
}

}  // namespace

Expansion::Sample Expansion::at(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                                const std::optional<Hold>& hold) const noexcept {
  const Equilibrium& e = equilibrium;
  const Eigen::Vector3d ds = s - place, dp = p - displacement;
  const Eigen::Vector3d force_by_p = e.stiffness * dp,
                        force_by_s = e.drive_stiffness.transpose() * ds,
                        drive_by_s = e.drive_slope * ds;
  // The second derivatives of the force, applied to (dp, dp), (dp, ds) and (ds, ds).
  const Eigen::Vector3d pp = symmetricOf(e.stiffness_by_p * dp) * dp,
                        ps = symmetricOf(e.stiffness_by_s * ds) * dp,
                        ss = twice(e.drive_slope_by_p, ds);
  const Eigen::Vector3d third = 0.5 * pp + ps + 0.5 * ss;
  Sample sample;
  sample.energy = e.energy - e.force.dot(dp) - e.drive.dot(ds) -
                  (0.5 * force_by_p + force_by_s).dot(dp) - 0.5 * drive_by_s.dot(ds) -
                  (pp / 6 + 0.5 * ps + 0.5 * ss).dot(dp);
  sample.force = e.force + force_by_p + force_by_s + third;
  sample.drive = e.drive + e.drive_stiffness * dp + drive_by_s + 0.5 * twice(e.stiffness_by_s, dp) +
                 symmetricOf(e.drive_slope_by_p * dp) * ds;
  sample.last_terms = e.stiffness_by_p.isZero(0) ? (force_by_p + force_by_s).norm() : third.norm();
  if (held && hold) addHold(*held, ds, dp, *hold, sample);
  return sample;
}

void Expansion::dropMeaningless(double distance) noexcept {
  if (equilibrium.stiffness_by_p.norm() * distance <= equilibrium.stiffness.norm()) return;
  equilibrium.stiffness_by_p.setZero();
  equilibrium.stiffness_by_s.setZero();
  equilibrium.drive_slope_by_p.setZero();
}

}  // namespace palpate
