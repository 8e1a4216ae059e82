#include <algorithm>
#include <cmath>
#include <utility>

#include "worker/solver/transition.hpp"

namespace palpate {
namespace {

constexpr int max_factorizations = 120;
constexpr int max_corrections = 6;
constexpr int easy_corrections = 3;
constexpr double absolute_tolerance = 1e-8, relative_tolerance = 1e-7;
/// First and smallest arc length of a step. At the start, an arc length of 1 moves the tool by
/// 1/sqrt(2) of the path to the target.
constexpr double first_length = 1.0 / 16, smallest_length = 1.0 / 65536;

/// Follows a curve of equilibria (x, s) step by step. x holds the unknowns; s is the position of
/// the tool, as a fraction of the straight path from the start to the target.
class Curve {
 public:
  Curve(const System& system, TangentSolver& solver, State start, const Eigen::Vector3d& target)
      : system_(system),
        solver_(solver),
        origin_(start.displacement),
        way_(target - start.displacement),
        state_(std::move(start)) {}

  double s() const { return s_; }
  bool turnedBack() const { return s_direction_ < 0; }
  int factorizations() const { return factorizations_; }
  std::int32_t negativePivots() const { return negative_pivots_; }

  bool begin() {
    if (!linearize(state_)) return false;
    weight_ = along_.norm();
    s_direction_ = 1;
    x_direction_ = Eigen::VectorXd::Zero(along_.size());
    turn();
    return true;
  }

  /// Advances by the arc length `length`. Returns the number of corrections, or 0 if they did not
  /// converge; the state is then unchanged.
  int advance(double length) {
    double s = s_ + length * s_direction_;
    State state = system_.moved(state_, x_direction_, length, origin_ + s * way_);
    for (int correction = 1; correction <= max_corrections; ++correction) {
      if (!linearize(state)) return 0;
      if (residual_.norm <=
          absolute_tolerance * system_.forceScale() + relative_tolerance * residual_.tool.norm()) {
        state_ = std::move(state);
        s_ = s;
        turn();
        return correction;
      }
      const double ds = -x_direction_.dot(correction_) /
                        (x_direction_.dot(along_) + weight_ * weight_ * s_direction_);
      s += ds;
      state = system_.moved(state, correction_ + ds * along_, 1, origin_ + s * way_);
    }
    return 0;
  }

 private:
  /// Computes Newton's correction at fixed s, and dx/ds. Returns false if the state is not
  /// admissible or the solve fails.
  bool linearize(const State& state) {
    system_.assemble(state, residual_, tangent_);
    if (!std::isfinite(residual_.norm)) return false;
    ++factorizations_;
    const Factorization factorization = solver_.factorize(tangent_);
    negative_pivots_ = factorization.negative_pivots;
    Eigen::MatrixXd columns(residual_.free.size(), 2);
    columns << -residual_.free, -(tangent_.tool_coupling * way_);
    if (!factorization.ok || !solver_.solve(columns) || !columns.allFinite()) return false;
    correction_ = columns.col(0);
    along_ = columns.col(1);
    return true;
  }

  /// Sets the direction of the curve at the current state, with the orientation of the previous
  /// direction.
  void turn() {
    const double length = std::hypot(along_.norm(), weight_) / weight_;
    const double same =
        x_direction_.dot(along_) + weight_ * weight_ * s_direction_ < 0 ? -1.0 : 1.0;
    x_direction_ = same / length * along_;
    s_direction_ = same / length;
  }

  const System& system_;
  TangentSolver& solver_;
  const Eigen::Vector3d origin_, way_;
  State state_;
  double s_ = 0, s_direction_ = 0, weight_ = 1;
  Eigen::VectorXd x_direction_, correction_, along_;
  Residual residual_;
  Tangent tangent_;
  int factorizations_ = 0;
  std::int32_t negative_pivots_ = 0;
};

/// A point at which the path of equilibria turns back.
struct LimitPoint {
  double at = 0;                     ///< largest s of the path
  std::int32_t negative_pivots = 0;  ///< of the tangent beyond the turn
};

/// Follows the equilibria from `start` (displacement p0) towards `target` (metres) by arc length,
/// with p = p0 + s (target - p0) and s as an unknown. Corrections lie in the plane normal to the
/// predictor (Riks 1979, Crisfield 1981).
///
/// Returns a limit point if s decreased along the continuous path and the inertia of the tangent
/// changed. Beyond the limit point this branch has no equilibrium, so no step size could have
/// reached the target. Returns nullopt if the target is reached after all, or if the path cannot be
/// followed (an element inverts, or max_factorizations are spent).
std::optional<LimitPoint> findLimitPoint(const System& system, TangentSolver& solver,
                                         const State& start, const Eigen::Vector3d& target) {
  Curve curve(system, solver, start, target);
  if (!curve.begin()) return std::nullopt;
  const std::int32_t stable_pivots = curve.negativePivots();
  LimitPoint limit;
  double length = first_length;
  while (length >= smallest_length && curve.factorizations() < max_factorizations &&
         curve.s() < 1) {
    const int corrections = curve.advance(length);
    if (corrections == 0) {
      length /= 2;
      continue;
    }
    if (corrections <= easy_corrections) length *= 1.5;
    limit.at = std::max(limit.at, curve.s());
    if (curve.turnedBack() && curve.s() < limit.at && curve.negativePivots() != stable_pivots) {
      limit.negative_pivots = curve.negativePivots();
      return limit;
    }
  }
  return std::nullopt;
}

}  // namespace

void TransitionSolver::explainByLimitPoint(const Start& start, const Eigen::Vector3d& target,
                                           Reached& failed) {
  const auto expected = system_.expectedNegativePivots();
  if (!expected) return;  // with spurious modes, a change of inertia would prove nothing
  const double reached = failed.outcome.failure().step_reached;
  const State& from = failed.end ? failed.end->state : start.state;
  const auto limit = findLimitPoint(system_, solver_, from, target);
  if (!limit) return;
  Failure& failure = failed.outcome.failure();
  failure.cause = Cause::limit_point;
  failure.step_reached = reached + (1 - reached) * limit->at;
  failure.negative_pivots = limit->negative_pivots;
  failure.expected_negative_pivots = *expected;
}

}  // namespace palpate
