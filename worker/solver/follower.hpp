#pragma once

#include <optional>

#include "common/space/following.hpp"
#include "worker/solver/path.hpp"

namespace palpate {

/// Solves for equilibria of a finger that follows a hand, each from the last one. The body stays on
/// the branch by which the hand came. One thread.
class Follower {
 public:
  /// `problem` must outlive this object. `radius`: of the finger, m. Error if the sparsity pattern
  /// cannot be analysed.
  Follower(const Problem& problem, const ElementKernels& kernels, double radius);

  /// Solves for the equilibrium where the hand will be when the answer is in use: the expected
  /// duration of the solve ahead, and half of it more. Begins from rest if there is no equilibrium
  /// yet, if the hand is far from the last one, or if the way from there fails. Error (bad input)
  /// if no finger can be at the hand's place, as beside fixed nodes.
  Followed follow(const HandMotion& hand);

  /// Forgets the last equilibrium: the hand has left the body.
  void release() { at_.reset(); }

 private:
  HandMotion aimed(const HandMotion& hand) const;
  Followed solveAt(const HandMotion& aim);
  bool isNear(const HandMotion& aim) const;
  Reached fromRest(const Finger& finger, const Eigen::Vector3d& target);

  const Problem& problem_;
  const double radius_;
  TransitionSolver solver_;
  std::optional<Start> at_;  ///< the last equilibrium
  double usual_seconds_ = 0;
};

}  // namespace palpate
