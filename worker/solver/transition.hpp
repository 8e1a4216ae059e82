#pragma once

#include <limits>

#include "common/mesh/finger_weights.hpp"
#include "common/space/expansion.hpp"
#include "worker/elements/kernel_family.hpp"
#include "worker/solver/newton.hpp"
#include "worker/solver/system.hpp"
#include "worker/solver/tangent_solver.hpp"

namespace palpate {

struct TransitionOptions {
  NewtonOptions newton = {};
  double smallest_step = 1.0 / 16;  ///< fraction of the transition
  /// A lattice transition that converges takes one or two factorisations. One that fails may cost
  /// about five times as many.
  int max_factorizations = 8;
  /// If a step takes at most this many factorisations, the next step is twice as long.
  int easy_factorizations = 1;
  /// Largest force of a finger, N. A transition is abandoned (Cause::beyond_force) if the stiffness
  /// at its start predicts a larger force at the target, or if the force after an intermediate step
  /// is larger. If the prediction is not larger and the transition converges in one step, its
  /// result is kept, however strong the force.
  double largest_force = std::numeric_limits<double>::infinity();
};

/// A finger's transitions are solved up to this multiple of the scene's max_force. Points beyond
/// max_force are needed because a cell with a missing corner gives answers only up to half an edge
/// from that corner. With a factor of 3, two thirds of the points of deep lattices lay beyond
/// max_force and took three quarters of the time, but touches up to max_force were no more
/// accurate. With 1.5, the answers in stiff tissue ended at 2 N although max_force was 3.3 N.
inline constexpr double solved_force_share = 2;

/// A configuration from which transitions can start, with its tangent predictor.
struct Start {
  State state;
  Eigen::MatrixXd sensitivity;  ///< d(unknowns and multipliers)/dp, 3 columns
  /// Force that the tool exerts, N; needed only for weighted tools. NodalFields do not contain the
  /// multiplier, so a start made from them has an estimate of this force.
  Eigen::Vector3d exerted = Eigen::Vector3d::Zero();
  // Only at the end of a finger's transition:
  Eigen::MatrixXd sensitivity_by_place = {};        ///< d(unknowns and multipliers)/ds, s = place
  Eigen::MatrixXd sensitivity_by_hold = {};         ///< by (h, t) of a hold (Held), or empty
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< of the finger, metres
  Eigen::Vector3d hold_place = Eigen::Vector3d::Zero();  ///< of a hold, metres
};

/// The result of a transition, or of a path of several transitions (path.hpp).
struct Reached {
  Outcome outcome;
  /// The configuration from which the next transition can start, in double precision. It is the
  /// outcome's configuration, or after a failure the last one that was reached. Empty if none was
  /// reached.
  std::optional<Start> end = {};
  std::optional<Held> held = {};  ///< if a second finger holds the body (TransitionSolver::hold)
  // Only for a path:
  int detours = 0;       ///< number of transitions via a point beside the path
  double min_det_F = 1;  ///< smallest det F at the ends of the transitions
};

/// Solves the configurations of one problem. Have at most one per process, because it owns a
/// LinearSolver, and use it from one thread.
class TransitionSolver {
 public:
  /// `problem` must outlive this object. Analyses the sparsity pattern once for all spaces; Error
  /// if that fails. Sets NewtonOptions::affine_descent itself, and replaces several options if the
  /// body has fibres.
  TransitionSolver(const Problem& problem, const ElementKernels& kernels,
                   TransitionOptions options = {});

  const System& system() const { return system_; }
  /// Chooses the tool of an active patch. Initially the first one is chosen.
  void chooseTool(std::size_t space);
  /// Chooses a finger at any place of the surface as the tool. Error (bad input) as from
  /// checkedFinger, with a message that begins with `what`.
  void placeFinger(const std::string& what, const Finger& finger);

  /// Prepare a start for transitions. startAtRest prepares the rest state, which under gravity is
  /// an equilibrium that is solved once. startFrom prepares the configuration with these nodal
  /// fields and the tool at `displacement`. A start costs one factorisation, which all targets
  /// around it share. On failure these functions return nullopt and set `failure`.
  std::optional<Start> startAtRest(Failure& failure);
  std::optional<Start> startFrom(const NodalFields& fields, const Eigen::Vector3d& displacement,
                                 Failure& failure);

  /// Moves the tool from `start` to `target` (metres) in steps. Each step consists of a tangent
  /// predictor, a relaxation near the tool, Newton and a check. A failed step is halved.
  ///
  /// A state is accepted if it is finite, if min det F > 0 (if the scene requires that) and if the
  /// tangent has the right inertia. If shorter steps do not help and an unstable equilibrium was
  /// met, the body is pushed along its critical mode once. This lets the path follow a column that
  /// buckles.
  ///
  /// The inertia is taken from the last tangent that Newton factorised. The sensitivities are
  /// solved by iterative refinement with the factors of that tangent. If the refinement converges
  /// fast, the tangent at the solution has the same inertia. Otherwise the tangent at the solution
  /// is factorised.
  ///
  /// Outcome::cost does not contain the factorisation of `start`, which all of its targets share.
  Reached reach(const Start& start, const Eigen::Vector3d& target);

  /// Lets the finger that reached `end` hold the body there, and chooses a second finger as the
  /// tool. Returns its start, in the same state of the body, in which the second finger exerts no
  /// force. On failure returns nullopt and sets `failure`. Errors as from placeFinger(). The hold
  /// ends with letGo().
  std::optional<Start> hold(const Start& end, const Finger& second, Failure& failure);
  void letGo();

  /// Moves a finger from `start` to a nearby place of the surface and to a nearby displacement
  /// `target`, metres. If the body is held, moves the hold, which has the finger's radius, to
  /// `hold`. Used by the live solver. Chooses the finger as the tool; errors as from placeFinger().
  /// `start`: the end of a follow() or of a finger's reach(). Uses the factors that the solver
  /// holds as long as they are good enough.
  ///
  /// The outcome is as valid as that of reach(), and lies on the branch of `start`. To save time,
  /// it is accurate to about five digits only, so it must not be stored in a dataset.
  Reached follow(const Start& start, const Finger& finger, const Eigen::Vector3d& target,
                 const Hold& hold = {});

  /// Checks whether a limit point is the reason for a failed transition. The search starts from the
  /// last state that `failed` reached. If there is a limit point, sets the cause in `failed` to
  /// Cause::limit_point, and step_reached to the position of that point. Costs as much as many
  /// transitions. Does nothing if the inertia is meaningless (System::expectedNegativePivots).
  void explainByLimitPoint(const Start& start, const Eigen::Vector3d& target, Reached& failed);

 private:
  /// Purpose of a step's end: start of the next step only (passed), answer to a hand (felt), or
  /// stored result (stored).
  enum class Use : std::uint8_t { passed, felt, stored };
  struct Step;
  struct Linearization;
  /// A finger at a place of the surface, metres.
  struct PlacedFinger : FingerWeights {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
  };

  PlacedFinger placed(const std::string& what, const Finger& finger) const;
  void moveHold(const Finger& finger);
  bool solveRest(Failure& failure);
  bool isTooStrong(const Eigen::Vector3d& force) const {
    return finger_ && force.norm() > options_.largest_force;
  }
  std::optional<Start> linearize(State state, Failure& failure);
  bool givesUp(const Start& start, const Eigen::Vector3d& way) const;
  State approach(const Start& from, const Eigen::Vector3d& displacement);
  Step step(const Start& from, const Eigen::Vector3d& displacement, bool last, int factorizations);
  Step solveFrom(State state, const Eigen::Vector3d& displacement, Use use,
                 const NewtonOptions& options);
  Cause judge(NewtonResult& newton, Use use, Linearization& here);
  Equilibrium equilibriumAt(const NewtonResult& newton, const Linearization& here) const;
  Cause accept(NewtonResult& newton, Use use, Step& step);
  Step stepAside(const Step& before, double way, bool last);
  void setFields(const State& state, const Eigen::Vector3d& target, Configuration& reached) const;
  void setDrive(const State& state, const Eigen::MatrixXd& slope_by_place,
                const TangentSolver::Refined& refined, Equilibrium& equilibrium) const;
  Eigen::MatrixXd slopeByPlace(const PlacedFinger& finger, const State& state,
                               const Eigen::Vector3d& multiplier, std::int32_t gap_row) const;
  Eigen::Matrix3d curvatureByPlace(const PlacedFinger& finger, const State& state,
                                   const Eigen::Vector3d& multiplier) const;
  Held heldAt(const State& state, const Linearization& here) const;
  std::optional<TangentSolver::Refined> solveSensitivity(NewtonResult& newton,
                                                         const Tangent& tangent,
                                                         const Eigen::MatrixXd& right_hand_sides,
                                                         double tolerance);

  const Problem& problem_;
  TransitionOptions options_;
  System system_;
  TangentSolver solver_;
  std::optional<std::size_t> space_;    ///< space of the chosen tool; none for a placed finger
  Tool tool_;                           ///< the chosen tool
  std::optional<PlacedFinger> finger_;  ///< if the tool is a finger
  std::optional<PlacedFinger> hold_;    ///< if a second finger holds the body
  Neighborhood near_tool_;              ///< nodes around a rigid tool, otherwise empty
  bool at_rest_ = false;                ///< the rest state of the system has been set
};

}  // namespace palpate
