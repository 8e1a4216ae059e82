#include "worker/solver/follower.hpp"

#include <cmath>

#include "common/base/error.hpp"
#include "common/problem/finger.hpp"

namespace palpate {
namespace {

/// Time from the latest position of the hand to the predicted one, in durations of a solve. An
/// answer is used from the end of its solve to the end of the next one. The prediction is for the
/// middle of this time.
constexpr double ahead = 1.5;
/// Upper limit of this time, s. Hands change their motion within a tenth of a second.
constexpr double longest_ahead = 0.15;
/// Weight of the last solve in the expected duration of a solve.
constexpr double newest_share = 0.3;
/// Distance from the last equilibrium, in finger radii, beyond which the path from rest is shorter
/// than the path along the surface.
constexpr double far_away = 2;

}  // namespace

Follower::Follower(const Problem& problem, const ElementKernels& kernels, double radius)
    : problem_(problem), radius_(radius), solver_(problem, kernels) {}

HandMotion Follower::aimed(const HandMotion& hand) const {
  const double time = std::min(ahead * usual_seconds_, longest_ahead);
  HandMotion aim = hand;
  aim.place += time * hand.place_speed;
  aim.displacement += time * hand.displacement_speed;
  return aim;
}

bool Follower::isNear(const HandMotion& aim) const {
  return at_ && (aim.place - at_->place).norm() <= far_away * radius_ &&
         (aim.displacement - at_->state.displacement).norm() <= far_away * radius_;
}

Reached Follower::fromRest(const Finger& finger, const Eigen::Vector3d& target) {
  solver_.placeFinger("hand", finger);
  Reached reached;
  const auto rest = solver_.startAtRest(reached.outcome.failure());
  if (!rest) return reached;
  const double spacings = target.norm() / problem_.scene.workspace.spacing;
  return walk(solver_, *rest, target, std::max(1, static_cast<int>(std::ceil(spacings))),
              Rescue::none);
}

Followed Follower::follow(const HandMotion& hand) {
  try {
    return solveAt(aimed(hand));
  } catch (const Error& error) {
    if (error.exitCode() != ExitCode::usage) throw;
  }
  try {
    return solveAt(hand);  // the predicted place was invalid, for instance beside fixed nodes
  } catch (const Error&) {
    release();  // the next solve starts at rest, in case fixed nodes are on the path
    throw;
  }
}

Followed Follower::solveAt(const HandMotion& aim) {
  const Finger finger = fingerNear("hand", problem_.mesh, aim.place, radius_);
  Reached reached;
  Cost spent;
  if (isNear(aim)) {
    reached = solver_.follow(*at_, finger, aim.displacement);
    spent = reached.outcome.cost;
  }
  if (!reached.outcome.converged()) {
    reached = fromRest(finger, aim.displacement);
    spent += reached.outcome.cost;
  }
  usual_seconds_ += newest_share * (spent.seconds - usual_seconds_);
  if (!reached.outcome.converged()) return {reached.outcome.failure(), spent};
  at_ = std::move(reached.end);
  return {Expansion{finger.center, aim.displacement, reached.outcome.equilibrium()}, spent};
}

}  // namespace palpate
