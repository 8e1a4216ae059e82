#include "worker/solver/follower.hpp"

#include <Eigen/Geometry>
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
constexpr const char *hand_name = "the hand", *hold_name = "the hold";  ///< in messages

}  // namespace

Follower::Follower(const Problem& problem, const ElementKernels& kernels, double radius)
    : problem_(problem),
      radius_(radius),
      free_share_(problem.mesh, problem.fixed, radius),
      solver_(problem, kernels) {
  Failure none;
  if (!solver_.startAtRest(none))
    throw failure("scene \"{}\" has no state at rest, so nothing can be solved: {}",
                  problem.scene.name, describe(none));
}

HandMotion Follower::aimed(const HandMotion& hand) const {
  const double time = std::min(ahead * usual_seconds_, longest_ahead);
  HandMotion aim = hand;
  aim.place += time * hand.place_speed;
  aim.displacement += time * hand.displacement_speed;
  return aim;
}

bool Follower::isNear(const HandMotion& aim) const {
  const auto areNear = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return (a - b).norm() <= far_away * radius_;
  };
  if (!at_ || aim.hold.has_value() != hold_.has_value()) return false;
  const bool is_held_alike = !hold_ || (areNear(aim.hold->place, hold_->place) &&
                                        areNear(aim.hold->displacement, hold_->displacement));
  return is_held_alike && areNear(aim.place, at_->place) &&
         areNear(aim.displacement, at_->state.displacement);
}

Reached Follower::pathFrom(const Start& start, const Eigen::Vector3d& target) {
  const double spacings =
      (target - start.state.displacement).norm() / problem_.scene.workspace.spacing;
  return walk(solver_, start, target, std::max(1, static_cast<int>(std::ceil(spacings))),
              Rescue::none);
}

Reached Follower::fromRest(const char* name, const Finger& finger, const Eigen::Vector3d& target) {
  solver_.placeFinger(name, finger);
  Reached reached;
  const auto rest = solver_.startAtRest(reached.outcome.failure());
  return rest ? pathFrom(*rest, target) : reached;
}

Reached Follower::fromRest(const Finger& finger, const HandMotion& aim) {
  // The solver may lose its hold here, or keep a new one after a failure. No later transition from
  // the last equilibrium would then have the equations of its hold.
  if (aim.hold || hold_) release();
  solver_.letGo();
  if (!aim.hold) return fromRest(hand_name, finger, aim.displacement);
  Reached held = fromRest(hold_name, {aim.hold->place, radius_}, aim.hold->displacement);
  if (!held.outcome.converged()) return held;
  Failure failure;
  const auto start = solver_.hold(*held.end, finger, failure);
  Reached reached;
  if (start)
    reached = pathFrom(*start, aim.displacement);
  else
    reached.outcome.end = failure;
  reached.outcome.cost += held.outcome.cost;
  return reached;
}

Followed Follower::follow(const HandMotion& hand) {
  try {
    return solveAt(aimed(hand));
  } catch (const Error& error) {
    if (error.exitCode() != ExitCode::usage) throw;
  }
  HandMotion reachable = hand;  // the predicted place was invalid, for instance beside fixed nodes
  if (const auto place = placeBeside(hand)) reachable.place = *place;
  try {
    return solveAt(reachable);
  } catch (const Error&) {
    release();  // the next solve starts at rest, in case fixed nodes are on the path
    throw;
  }
}

/// Returns a place near the hand where a finger can be, between the hand and the last equilibrium.
/// Returns nullopt if one can be at the hand's place, or if that is far away. On the way from the
/// last equilibrium a finger may soon meet fixed nodes, so it first tries to pass beside them.
std::optional<Eigen::Vector3d> Follower::placeBeside(const HandMotion& hand) const {
  const auto nearestTo = [&](const Eigen::Vector3d& point) {
    return fingerNear(hand_name, problem_.mesh, point, radius_).center;
  };
  const auto isFree = [&](const Eigen::Vector3d& point) {
    return !free_share_.isBelow(least_free_share, point);
  };
  if (!at_) return std::nullopt;
  const Eigen::Vector3d way = hand.place - at_->place;
  if (way.norm() > far_away * radius_ || isFree(nearestTo(hand.place))) return std::nullopt;
  const Eigen::Vector3d axis = hand.displacement.stableNormalized();
  for (const double angle : {0.3, -0.3, 0.6, -0.6, 0.9, -0.9, 1.2, -1.2}) {
    // In this direction, this is the point nearest to the hand.
    const Eigen::Vector3d next = nearestTo(
        at_->place + std::cos(angle) * (Eigen::AngleAxisd(angle, axis).toRotationMatrix() * way));
    if (isFree(next)) return next;
  }
  return at_->place;
}

Followed Follower::solveAt(HandMotion aim) {
  refuseMistakenUnit(problem_.mesh, aim.displacement);
  const Finger finger = fingerNear(hand_name, problem_.mesh, aim.place, radius_);
  if (aim.hold) {
    refuseMistakenUnit(problem_.mesh, aim.hold->displacement);
    aim.hold->place = fingerNear(hold_name, problem_.mesh, aim.hold->place, radius_).center;
  }
  Reached reached;
  Cost spent;
  if (isNear(aim)) {
    reached = solver_.follow(*at_, finger, aim.displacement, aim.hold.value_or(Hold()));
    spent = reached.outcome.cost;
  }
  if (!reached.outcome.converged()) {
    reached = fromRest(finger, aim);
    spent += reached.outcome.cost;
  }
  usual_seconds_ += newest_share * (spent.seconds - usual_seconds_);
  if (!reached.outcome.converged()) return {reached.outcome.failure(), spent};
  at_ = std::move(reached.end);
  hold_ = aim.hold;
  return {Expansion{finger.center, aim.displacement, reached.outcome.equilibrium(), reached.held},
          spent};
}

}  // namespace palpate
