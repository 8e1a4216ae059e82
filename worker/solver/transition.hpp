#pragma once

#include <limits>

#include "common/mesh/finger_weights.hpp"
#include "common/space/configuration.hpp"
#include "worker/elements/kernel_family.hpp"
#include "worker/solver/newton.hpp"
#include "worker/solver/system.hpp"
#include "worker/solver/tangent_solver.hpp"

namespace palpate {

struct TransitionOptions {
  NewtonOptions newton = {};
  /// Of NewtonOptions, for the steps on the way, which nobody stores.
  double loose_absolute_tolerance = 1e-6, loose_relative_tolerance = 1e-5;
  double smallest_step = 1.0 / 16;  ///< fraction of the transition
  /// A lattice transition takes one or two factorisations; one that fails may cost about five times
  /// that, no more.
  int max_factorizations = 8;
  int easy_factorizations = 1;  ///< after a step with no more of them the next one is longer
  /// N. A transition of a finger is given up (Cause::beyond_force) where the force on the way is
  /// larger, or that which the start's stiffness predicts for the target. What converges in one
  /// step is kept, however strong.
  double largest_force = std::numeric_limits<double>::infinity();
};

/// The largest force of a finger that is still computed, in max_force of the scene. A cell answers
/// in half of an edge to a corner that is missing, and so up to max_force. With 3 what is beyond it
/// was two thirds of the points of deep lattices and three quarters of the time, and no touch up to
/// max_force was kept better; with 1.5 the answer ended at 2 of 3.3 N where tissue is stiff.
inline constexpr double solved_force_share = 2;

/// A configuration that transitions start from: where it is, and its tangent predictor.
struct Start {
  State state;
  Eigen::MatrixXd sensitivity;  ///< d(unknowns, multipliers)/dp, rows x 3
  /// N, what a weighted tool exerts; else zero. Fields that are started from lack the multiplier.
  Eigen::Vector3d exerted = Eigen::Vector3d::Zero();
};

/// Where a transition led, or a path of several (path.hpp).
struct Reached {
  Outcome outcome;
  /// The configuration to go on from, in double precision: that of the outcome, or where the way
  /// failed the last one on it. Nothing when there was none.
  std::optional<Start> end = {};
  // Of a path:
  int detours = 0;       ///< transitions that were made by way of a point beside it
  double min_det_F = 1;  ///< smallest of the configurations between its transitions and at its end
};

/// Solves the configurations of one problem. One per process (it owns the LinearSolver), one
/// thread.
class TransitionSolver {
 public:
  /// `problem` must outlive it. Analyses the sparsity pattern, once for all spaces. Error when that
  /// fails. Bodies with fibres get what they need beside `options`.
  TransitionSolver(const Problem& problem, const ElementKernels& kernels,
                   TransitionOptions options = {});

  const System& system() const { return system_; }
  /// Of the active patches; the first one is chosen at the beginning.
  void chooseTool(std::size_t space);
  /// A finger anywhere on the surface; it stays until a tool is chosen. Error (bad input), which
  /// begins with `what`, as of checkedFinger.
  void placeFinger(const std::string& what, const Finger& finger);

  /// The rest state (under gravity the equilibrium that it leads to, solved here once), or the
  /// configuration with these nodal fields at `displacement`, made ready to start from: one
  /// factorisation, shared by all targets around it. Nothing when that fails; `failure` then says
  /// why.
  std::optional<Start> startAtRest(Failure& failure);
  std::optional<Start> startFrom(const NodalFields& fields, const Eigen::Vector3d& displacement,
                                 Failure& failure);

  /// Moves the tool from `start` to `target` (metres), in steps: tangent predictor, relaxation near
  /// the tool, Newton, check, and half the step when it failed. A state is accepted when it is
  /// finite, min det F > 0 (if the scene says so) and the tangent has the right inertia. Where
  /// shorter steps lead no further and an unstable equilibrium was met, the body is pushed out of
  /// it along its critical mode once, so that a column that buckles is followed.
  ///
  /// The inertia is that of the last tangent that Newton factorised; the tangent at the solution
  /// has the same when the sensitivities, which are solved for it with those factors, contract
  /// fast, and is factorised itself when they do not.
  ///
  /// Outcome::cost counts what this transition took, the factorisation of `start` excepted (it is
  /// shared).
  Reached reach(const Start& start, const Eigen::Vector3d& target);

  /// After a transition failed: whether a limit point is why, sought from where `failed` got to.
  /// When it is, `failed` says so: Cause::limit_point, and step_reached where it lies. Costs many
  /// times a transition. Not looked for where the inertia says nothing
  /// (System::expectedNegativePivots).
  void explainByLimitPoint(const Start& start, const Eigen::Vector3d& target, Reached& failed);

 private:
  struct Step;
  struct Linearization;

  bool solveRest(Failure& failure);
  bool isTooStrong(const Eigen::Vector3d& force) const {
    return finger_ && force.norm() > options_.largest_force;
  }
  std::optional<Start> linearize(State state, Failure& failure);
  bool givesUp(const Start& start, const Eigen::Vector3d& way) const;
  State approach(const Start& from, const Eigen::Vector3d& displacement);
  Step step(const Start& from, const Eigen::Vector3d& displacement, bool last, int factorizations);
  Cause judge(NewtonResult& newton, bool last, Linearization& here);
  Equilibrium equilibriumAt(const NewtonResult& newton, const Linearization& here) const;
  Cause accept(NewtonResult& newton, bool last, Step& step);
  Step stepAside(const Step& before, double way, bool last);
  void setFields(const State& state, const Eigen::Vector3d& target, Configuration& reached) const;
  void setDrive(const State& state, const Eigen::MatrixXd& slope_by_place,
                const TangentSolver::Refined& refined, Equilibrium& equilibrium) const;
  Eigen::MatrixXd slopeByPlace(const State& state) const;
  std::optional<TangentSolver::Refined> solveSensitivity(NewtonResult& newton,
                                                         const Tangent& tangent,
                                                         const Eigen::MatrixXd& right_hand_sides,
                                                         double tolerance);

  const Problem& problem_;
  TransitionOptions options_;
  System system_;
  TangentSolver solver_;
  std::optional<std::size_t> space_;     ///< of the chosen tool, unless it is a placed finger
  Tool tool_;                            ///< the chosen one
  std::optional<FingerWeights> finger_;  ///< of a finger
  Neighborhood near_tool_;               ///< of a rigid tool, else empty
  bool at_rest_ = false;                 ///< the system knows its rest state
};

}  // namespace palpate
