#pragma once

#include <optional>

#include "common/space/expansion.hpp"

namespace palpate {

/// Position and velocity of a finger that a hand moves.
struct HandMotion {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();         ///< of the finger on the surface, m
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d place_speed = Eigen::Vector3d::Zero();   ///< m/s
  Eigen::Vector3d displacement_speed = Eigen::Vector3d::Zero();  ///< m/s
  std::optional<Hold> hold = {};  ///< a second finger that holds the body
};

/// The equilibrium near a hand, or a Failure if there is none, and the cost of the solve.
struct Followed {
  std::variant<Failure, Expansion> end;
  Cost cost;

  bool converged() const { return std::holds_alternative<Expansion>(end); }
  /// Valid if converged().
  const Expansion& expansion() const { return std::get<Expansion>(end); }
  /// Valid if not converged().
  const Failure& failure() const { return std::get<Failure>(end); }
};

}  // namespace palpate
