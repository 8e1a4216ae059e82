#pragma once

#include <optional>

#include "common/mesh/free_share.hpp"
#include "common/space/following.hpp"
#include "worker/solver/path.hpp"

namespace palpate {

/// The live solver: finds equilibria of a finger near a moving hand. Each solve starts from the
/// last equilibrium, so the body stays on its branch. One thread.
class Follower {
 public:
  /// Solves the state at rest. `problem` must outlive this object. `radius`: radius of the finger,
  /// m. Error if there is no state at rest, or if the sparsity pattern cannot be analysed.
  Follower(const Problem& problem, const ElementKernels& kernels, double radius);

  /// Predicts the position of the hand after 1.5 times the expected duration of a solve, and solves
  /// for the equilibrium there. Starts from rest if there is no equilibrium yet, if the hand or the
  /// hold is far from the last equilibrium, if a hold begins or ends, or if the transition from the
  /// last equilibrium fails. From rest, the hold comes first and then the hand.
  ///
  /// If the hand slides to where no finger can be, because fixed nodes are too near, the
  /// equilibrium is beside it, where one can be. Error (bad input) if the last equilibrium is far
  /// away then, if no finger can be at the place of the hold, or if a displacement is larger than
  /// the body.
  Followed follow(const HandMotion& hand);

  /// Forgets the last equilibrium. Call it when the hand has left the body.
  void release() { at_.reset(); }

 private:
  HandMotion aimed(const HandMotion& hand) const;
  Followed solveAt(HandMotion aim);
  std::optional<Eigen::Vector3d> placeBeside(const HandMotion& hand) const;
  bool isNear(const HandMotion& aim) const;
  Reached pathFrom(const Start& start, const Eigen::Vector3d& target);
  Reached fromRest(const char* name, const Finger& finger, const Eigen::Vector3d& target);
  Reached fromRest(const Finger& finger, const HandMotion& aim);

  const Problem& problem_;
  const double radius_;
  const FreeShare free_share_;
  TransitionSolver solver_;
  std::optional<Start> at_;   ///< the last equilibrium
  std::optional<Hold> hold_;  ///< the hold in the last equilibrium
  double usual_seconds_ = 0;
};

}  // namespace palpate
