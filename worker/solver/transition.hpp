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
  /// NewtonOptions tolerances of intermediate steps, which are not stored.
  double loose_absolute_tolerance = 1e-6, loose_relative_tolerance = 1e-5;
  double smallest_step = 1.0 / 16;  ///< fraction of the transition
  /// A lattice transition takes one or two factorisations. A failing one may cost about five times
  /// that.
  int max_factorizations = 8;
  int easy_factorizations = 1;  ///< a step with at most this many makes the next step longer
  /// N. A finger's transition is abandoned (Cause::beyond_force) if the start's stiffness predicts
  /// a larger force at the target, or if the force after an intermediate step is larger. A
  /// transition that passes the prediction and converges in one step is kept, however strong the
  /// force.
  double largest_force = std::numeric_limits<double>::infinity();
};

/// Largest finger force that is still computed, as a multiple of the scene's max_force. A cell
/// answers up to half an edge from a missing corner, and thus up to max_force. With 3, two thirds
/// of the points of deep lattices and three quarters of the time went beyond max_force, and no
/// touch up to max_force was more accurate. With 1.5 the answer ended at 2 of 3.3 N where tissue is
/// stiff.
inline constexpr double solved_force_share = 2;

/// A configuration that transitions start from, with its tangent predictor.
struct Start {
  State state;
  Eigen::MatrixXd sensitivity;  ///< d(unknowns, multipliers)/dp, rows x 3
  /// Force that a weighted tool exerts, N; otherwise zero. NodalFields do not contain the
  /// multiplier.
  Eigen::Vector3d exerted = Eigen::Vector3d::Zero();
};

/// The result of a transition, or of a path of several (path.hpp).
struct Reached {
  Outcome outcome;
  /// The configuration to continue from, in double precision: the outcome's, or after a failure the
  /// last one that was reached. Empty if there was none.
  std::optional<Start> end = {};
  // Only for a path:
  int detours = 0;       ///< transitions that went through a point beside the path
  double min_det_F = 1;  ///< smallest at the ends of its transitions
};

/// Solves the configurations of one problem. One per process (it owns the LinearSolver), one
/// thread.
class TransitionSolver {
 public:
  /// `problem` must outlive it. Analyses the sparsity pattern once for all spaces; Error if that
  /// fails. For bodies with fibres some `options` are replaced.
  TransitionSolver(const Problem& problem, const ElementKernels& kernels,
                   TransitionOptions options = {});

  const System& system() const { return system_; }
  /// Chooses the tool of an active patch. Initially the first one is chosen.
  void chooseTool(std::size_t space);
  /// Places a finger anywhere on the surface, until a tool is chosen. Error (bad input) as from
  /// checkedFinger, with the prefix `what`.
  void placeFinger(const std::string& what, const Finger& finger);

  /// Prepare a start: the rest state (under gravity its equilibrium, solved once), or the
  /// configuration with these nodal fields at `displacement`. Costs one factorisation, shared by
  /// all targets around the start. Return nothing on failure, and the reason in `failure`.
  std::optional<Start> startAtRest(Failure& failure);
  std::optional<Start> startFrom(const NodalFields& fields, const Eigen::Vector3d& displacement,
                                 Failure& failure);

  /// Moves the tool from `start` to `target` (metres) in steps: tangent predictor, relaxation near
  /// the tool, Newton, check. A failed step is halved.
  ///
  /// A state is accepted if it is finite, if min det F > 0 (if the scene requires that) and if the
  /// tangent has the right inertia. If shorter steps do not help and an unstable equilibrium was
  /// met, the body is pushed along its critical mode once, so that the path follows a column that
  /// buckles.
  ///
  /// The inertia is taken from the last tangent that Newton factorised. If the sensitivities, which
  /// are solved with these factors, contract fast, the tangent at the solution has the same
  /// inertia; otherwise it is factorised itself.
  ///
  /// Outcome::cost is the cost of this transition without the factorisation of `start`, which is
  /// shared.
  Reached reach(const Start& start, const Eigen::Vector3d& target);

  /// Checks whether a limit point is the reason for a failed transition; the search starts from the
  /// last state of `failed`. If so, sets Cause::limit_point in `failed`, and step_reached to its
  /// position. Costs many times a transition. Does nothing if the inertia is meaningless
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
  Tool tool_;                            ///< the chosen tool
  std::optional<FingerWeights> finger_;  ///< if the tool is a finger
  Neighborhood near_tool_;               ///< of a rigid tool, otherwise empty
  bool at_rest_ = false;                 ///< the rest state of the system has been set
};

}  // namespace palpate
