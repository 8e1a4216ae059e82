#include "worker/solver/transition.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/problem/finger.hpp"
#include "worker/solver/critical_mode.hpp"
#include "worker/solver/element_geometry.hpp"
#include "worker/solver/third_derivatives.hpp"

namespace palpate {
namespace {

/// Largest relative residual of du/dp. The error of the stiffness is about the square of this
/// residual, 1e-10.
constexpr double sensitivity_tolerance = 1e-5;
/// Largest relative residual of du/dp after intermediate steps, where it is only a predictor, and
/// in the live solver (Use::felt), whose third derivatives have this relative error.
constexpr double loose_sensitivity_tolerance = 1e-2, felt_sensitivity_tolerance = 1e-3;
/// Tolerance of the relaxation near the tool, times System::forceScale(). The relaxation need not
/// be accurate, because Newton follows it.
constexpr double relaxation_tolerance = 1e-3;
/// Smallest fraction of a movement that approach() tries to relax. Smallest load step of
/// solveRest(), as a fraction of gravity.
constexpr double smallest_approach = 1.0 / 16;
constexpr double smallest_load_step = 1.0 / 64;
/// Largest displacement along a critical mode, relative to the first one that is tried.
constexpr double widest_step_aside = 4;
constexpr int aside_factorizations = 12;
/// Relative difference of energies below which two equilibria are taken for symmetric twins.
constexpr double twin_energy = 1e-6;

/// Returns the CPU time of this thread, which does all of the solving. It does not include time in
/// which the process was stopped.
double threadSeconds() {
  timespec time{};
  if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time) != 0)
    throw failure("clock_gettime: {}", errnoText());
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Returns the number of nodes in the neighbourhood of a rigid tool: a twentieth of all nodes,
/// within a range in which dense matrices are cheap.
std::size_t nodesNearTool(const Mesh& mesh) {
  return std::clamp<std::size_t>(mesh.nodes.size() / 20, 16, 80);
}

Failure failureOf(Cause cause, const NewtonResult& newton) {
  return {.cause = cause,
          .residual = newton.residual.norm,
          .element = newton.residual.worst_element,
          .element_det_F = newton.residual.min_det_F,
          .negative_pivots = newton.factorization.negative_pivots,
          .mumps_infog1 = newton.factorization.infog1,
          .mumps_infog2 = newton.factorization.infog2};
}

/// Returns whether Newton converged to an unstable equilibrium: more negative pivots than expected.
bool isUnstable(const Failure& failure) {
  return failure.cause == Cause::wrong_inertia &&
         failure.negative_pivots > failure.expected_negative_pivots;
}

/// Adapts the options to bodies with fibres, whose stiffness jumps where a fibre becomes taut.
/// Newton finds the set of taut fibres with one tangent per iteration (semismooth Newton; Qi and
/// Sun 1993). This takes 5 tangents if k1 is ten times mu, and 25 if k1 is a thousand times mu. If
/// the tool moves far, it also takes several steps.
TransitionOptions optionsFor(const Problem& problem, TransitionOptions options) {
  if (problem.fibers.empty()) return options;
  options.newton.renew_always = true;
  options.newton.max_factorizations = 40;
  options.max_factorizations = 200;
  options.easy_factorizations = 8;
  return options;
}

/// Loosens the tolerances for a state that is not stored.
NewtonOptions loosened(NewtonOptions options) {
  options.absolute_tolerance = 1e-6;
  options.relative_tolerance = 1e-5;
  return options;
}

}  // namespace

/// One step of a transition: the accepted configuration, or why there is none.
struct TransitionSolver::Step {
  /// Cause::none if accepted. In either case the numbers describe Newton's last state.
  Failure failure;
  Cost cost;
  bool easy = false;  ///< Newton took few tangents; the next step may be longer
  // Only for an accepted step:
  Equilibrium equilibrium;
  std::optional<Held> held;
  Start end;
};

/// The linearised equations at a state to which Newton converged.
struct TransitionSolver::Linearization {
  Tangent tangent;
  /// -d(Residual::free)/dp. At the end of a finger's transition the columns of slopeByPlace() and,
  /// with a hold, the derivatives with respect to its displacement and its place follow.
  Eigen::MatrixXd right_hand_sides;
  TangentSolver::Refined sensitivity;  ///< solution for these right-hand sides
};

TransitionSolver::TransitionSolver(const Problem& problem, const ElementKernels& kernels,
                                   TransitionOptions options)
    : problem_(problem),
      options_(optionsFor(problem, options)),
      system_(problem, kernels),
      solver_(system_) {
  options_.newton.affine_descent = hasNearlyRigidPart(system_.model());
  chooseTool(0);
}

void TransitionSolver::chooseTool(std::size_t space) {
  if (space_ == space) return;
  const ActivePatch& patch = problem_.active.at(space);
  if (patch.finger) {
    placeFinger(patch.name, *patch.finger);
  } else {
    finger_.reset();
    tool_ = {patch.nodes, patch.weights};
    system_.chooseTool(tool_);
    near_tool_ =
        tool_.weights.empty() ? system_.neighborhood(nodesNearTool(problem_.mesh)) : Neighborhood{};
  }
  space_ = space;
}

void TransitionSolver::placeFinger(const std::string& what, const Finger& finger) {
  finger_ = placed(what, finger);
  tool_ = {finger_->nodes, finger_->weights};
  system_.chooseTool(tool_);
  near_tool_ = {};
  space_.reset();
}

TransitionSolver::PlacedFinger TransitionSolver::placed(const std::string& what,
                                                        const Finger& finger) const {
  PlacedFinger placed = {checkedFinger(what, problem_.mesh, problem_.fixed, finger), finger.center};
  PALPATE_ASSERT(placed.gradients.size() == placed.nodes.size() &&
                     placed.curvatures.size() == placed.nodes.size(),
                 "a finger's weights must have derivatives with respect to its place");
  return placed;
}

std::optional<Start> TransitionSolver::startAtRest(Failure& failure) {
  if (!solveRest(failure)) return std::nullopt;
  return linearize(system_.restState(), failure);
}

std::optional<Start> TransitionSolver::startFrom(const NodalFields& fields,
                                                 const Eigen::Vector3d& displacement,
                                                 Failure& failure) {
  if (!solveRest(failure)) return std::nullopt;
  State state = system_.restState();
  PALPATE_ASSERT(
      fields.displacement.size() == state.u.size() && fields.pressure.size() == state.q.size(),
      "the fields must be of this problem");
  std::copy(fields.displacement.begin(), fields.displacement.end(), state.u.begin());
  for (std::size_t node = 0; node < state.q.size(); ++node)
    state.q[node] = fields.pressure[node] / system_.pressureScale();
  // This also returns the nodes of a rigid tool to their exact positions, which float32 had
  // rounded.
  const Eigen::VectorXd nowhere = Eigen::VectorXd::Zero(system_.unknowns() + system_.multipliers());
  state = system_.moved(state, nowhere, 0, displacement);
  return linearize(std::move(state), failure);
}

bool TransitionSolver::solveRest(Failure& failure) {
  if (at_rest_) return true;
  if (problem_.scene.gravity.isZero()) return at_rest_ = true;
  system_.releaseTool();
  State state = system_.restState();
  double at = 0, step = 1;
  while (at < 1) {
    const double next = std::min(1.0, at + step);
    system_.setLoadFactor(next);
    NewtonResult newton =
        findEquilibrium(system_, solver_, state, Eigen::Vector3d::Zero(), options_.newton);
    const auto expected = system_.expectedNegativePivots();
    // If Newton needed no factorisation, the load was too small to move anything, and there is no
    // count of pivots.
    const bool unstable = newton.cause == Cause::none && newton.factorizations > 0 && expected &&
                          newton.factorization.negative_pivots != *expected;
    if (unstable) newton.cause = Cause::wrong_inertia;
    if (newton.cause == Cause::none) {
      state = std::move(newton.state);
      at = next;
      continue;
    }
    step = (next - at) / 2;
    if (step < smallest_load_step) {
      failure = failureOf(newton.cause, newton);
      if (unstable) failure.expected_negative_pivots = *expected;
      return false;
    }
  }
  system_.setRest(state);
  system_.chooseTool(tool_);
  return at_rest_ = true;
}

std::optional<Start> TransitionSolver::linearize(State state, Failure& failure) {
  NewtonResult here;
  Tangent tangent;
  system_.assemble(state, here.residual, tangent);
  if (!std::isfinite(here.residual.norm)) {
    failure = failureOf(causeOfNotFinite(here.residual), here);
    return std::nullopt;
  }
  auto sensitivity = solveSensitivity(here, tangent, -tangent.tool_coupling, sensitivity_tolerance);
  if (!sensitivity) {
    failure = failureOf(Cause::factorization_failed, here);
    return std::nullopt;
  }
  PALPATE_ASSERT(sensitivity->solution.rows() == system_.unknowns() + system_.multipliers(),
                 "each unknown and multiplier must have a derivative");
  Start start = {std::move(state), std::move(sensitivity->solution)};
  // The multiplier that balances the body best (least squares). At an equilibrium it is the
  // multiplier of the equilibrium.
  // Beside a hold, the tool starts without force.
  if (system_.multipliers() > 0 && !hold_) {
    const Eigen::Matrix3d weight = tangent.border.transpose() * tangent.border;
    start.exerted = start.state.multiplier -
                    weight.inverse() *
                        (tangent.border.transpose() * here.residual.free.head(system_.unknowns()));
  }
  return start;
}

/// Returns whether the stiffness at `start` predicts too large a force of the finger after the
/// movement `way`.
bool TransitionSolver::givesUp(const Start& start, const Eigen::Vector3d& way) const {
  return finger_ && isTooStrong(start.exerted + start.sensitivity.bottomRows<3>() * way);
}

/// Returns the state with the tool at `displacement`, after the predictor and the relaxation near
/// the tool. Nodes outside the neighbourhood of the tool follow the predictor. The movement is
/// divided into as many parts as the relaxation needs.
State TransitionSolver::approach(const Start& from, const Eigen::Vector3d& displacement) {
  const Eigen::Vector3d way = displacement - from.state.displacement;
  const Eigen::VectorXd predictor = from.sensitivity * way;
  State state = from.state;
  double at = 0, next = 1;
  while (next - at >= smallest_approach) {
    State trial = system_.moved(state, predictor, next - at,
                                next == 1 ? displacement : from.state.displacement + next * way);
    if (relaxNearTool(system_, near_tool_, trial, relaxation_tolerance * system_.forceScale())) {
      if (next == 1) return trial;
      state = std::move(trial);
      at = std::exchange(next, 1);
    } else {
      next = (at + next) / 2;
    }
  }
  return system_.moved(state, predictor, 1 - at, displacement);
}

/// Solves for du/dp, and for du/ds if the right-hand sides include it. Refines with Newton's last
/// factors. If that does not converge, factorises `tangent` and records this factorisation in
/// `newton`.
std::optional<TangentSolver::Refined> TransitionSolver::solveSensitivity(
    NewtonResult& newton, const Tangent& tangent, const Eigen::MatrixXd& right_hand_sides,
    double tolerance) {
  if (newton.factorization.ok)
    if (auto refined = solver_.solveWith(tangent, right_hand_sides, tolerance)) return refined;
  newton.factorization = solver_.factorize(tangent);
  ++newton.factorizations;
  if (!newton.factorization.ok) return std::nullopt;
  return solver_.solveWith(tangent, right_hand_sides, tolerance);
}

/// Returns -d(Residual::free)/ds of a finger with this multiplier, one column per axis. Rows of
/// unknowns are B'^T multiplier, and the rows of the multiplier, from gap_row on, are
/// B' (u - u_rest), with B' = dB/ds for the weights B.
Eigen::MatrixXd TransitionSolver::slopeByPlace(const PlacedFinger& finger, const State& state,
                                               const Eigen::Vector3d& multiplier,
                                               std::int32_t gap_row) const {
  Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(system_.unknowns() + system_.multipliers(), 3);
  const State& rest = system_.restState();
  for (std::size_t n = 0; n < finger.nodes.size(); ++n) {
    const std::int32_t node = finger.nodes[n];
    const Eigen::Vector3d& gradient = finger.gradients[n];
    slope.middleRows<3>(gap_row) +=
        (ofNode(state.u, at(node)) - ofNode(rest.u, at(node))) * gradient.transpose();
    for (int i = 0; i < 3; ++i)
      slope.row(system_.numbers().at({node, i})) = multiplier[i] * gradient.transpose();
  }
  return slope;
}

/// Returns multiplier . B'' (u - u_rest), with B'' = d2B/ds2 for the weights B of a finger.
Eigen::Matrix3d TransitionSolver::curvatureByPlace(const PlacedFinger& finger, const State& state,
                                                   const Eigen::Vector3d& multiplier) const {
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
  const State& rest = system_.restState();
  for (std::size_t n = 0; n < finger.nodes.size(); ++n) {
    const auto node = at(finger.nodes[n]);
    curvature +=
        multiplier.dot(ofNode(state.u, node) - ofNode(rest.u, node)) * finger.curvatures[n];
  }
  return curvature;
}

/// Sets the derivatives of the energy with respect to s. A is the matrix of a Newton step, r is
/// slopeByPlace(), and m is the multiplier. If s moves by ds and the unknowns by A^-1 r ds, the
/// equations stay satisfied. So
///   dE/ds = -m . B' (u - u_rest)
///   d2E/dp ds = -(du/dp)^T r
///   d2E/ds2 = -r^T A^-1 r - m . B'' (u - u_rest)
/// The code also uses the residuals of the solutions, which makes the results' errors of second
/// order in the errors of the solutions.
void TransitionSolver::setDrive(const State& state, const Eigen::MatrixXd& r,
                                const TangentSolver::Refined& refined,
                                Equilibrium& equilibrium) const {
  const auto by_p = refined.solution.leftCols<3>(), by_s = refined.solution.middleCols<3>(3);
  const auto left_by_p = refined.residual.leftCols<3>(),
             left_by_s = refined.residual.middleCols<3>(3);
  const Eigen::Matrix3d slope = r.transpose() * by_s - by_s.transpose() * left_by_s +
                                curvatureByPlace(*finger_, state, state.multiplier);
  const Eigen::Matrix3d by_displacement = r.transpose() * by_p - by_s.transpose() * left_by_p;
  // Added to zero, so that a zero is 0 and not -0.
  equilibrium.drive = Eigen::Vector3d::Zero() + r.bottomRows<3>().transpose() * state.multiplier;
  equilibrium.drive_stiffness = Eigen::Matrix3d::Zero() + by_displacement;
  equilibrium.drive_slope = Eigen::Matrix3d::Zero() + 0.5 * (slope + slope.transpose());
}

/// Returns why the state to which Newton converged is rejected, or Cause::none if it is accepted.
/// Stores the linearised equations at this state in `here`.
Cause TransitionSolver::judge(NewtonResult& newton, Use use, Linearization& here) {
  system_.assemble(newton.state, newton.residual, here.tangent);
  if (const SmallestDetF at_nodes = smallestDetFAtNodes(system_.model().mesh, newton.state.u);
      at_nodes.det_F < newton.residual.min_det_F) {
    newton.residual.min_det_F = at_nodes.det_F;
    newton.residual.worst_element = at_nodes.element;
  }
  if (problem_.scene.workspace.reject_inverted && !(newton.residual.min_det_F > 0))
    return Cause::inverted_element;
  here.right_hand_sides = -here.tangent.tool_coupling;
  if (use != Use::passed && finger_) {
    const State& state = newton.state;
    const std::int32_t first = system_.unknowns(), last = first + system_.multipliers() - 3;
    here.right_hand_sides.conservativeResize(Eigen::NoChange, hold_ ? 12 : 6);
    here.right_hand_sides.middleCols<3>(3) = slopeByPlace(*finger_, state, state.multiplier, last);
    if (hold_) {
      here.right_hand_sides.middleCols<3>(6).setZero();
      here.right_hand_sides.block<3, 3>(first, 6) = -Eigen::Matrix3d::Identity();
      here.right_hand_sides.rightCols<3>() =
          slopeByPlace(*hold_, state, state.held_multiplier, first);
    }
  }
  auto sensitivity = solveSensitivity(newton, here.tangent, here.right_hand_sides,
                                      use == Use::stored ? sensitivity_tolerance
                                      : use == Use::felt ? felt_sensitivity_tolerance
                                                         : loose_sensitivity_tolerance);
  if (!sensitivity) return Cause::factorization_failed;
  here.sensitivity = std::move(*sensitivity);
  const auto expected = system_.expectedNegativePivots();
  return expected && newton.factorization.negative_pivots != *expected ? Cause::wrong_inertia
                                                                       : Cause::none;
}

/// Returns the energy and its derivatives at a state that judge() accepted.
Equilibrium TransitionSolver::equilibriumAt(const NewtonResult& newton,
                                            const Linearization& here) const {
  const Tangent& tangent = here.tangent;
  PALPATE_ASSERT(here.sensitivity.solution.cols() == here.right_hand_sides.cols(),
                 "each right-hand side needs a solution");
  // The stiffness is K_aa + S^T K S + 2 S^T C. As K S = -C + R with the residual R, it equals K_aa
  // + C^T S + S^T R. Its error is of second order in the error of S.
  const Eigen::MatrixXd S = here.sensitivity.solution.leftCols<3>();
  const Eigen::Matrix3d K = tangent.tool + tangent.tool_coupling.transpose() * S +
                            S.transpose() * here.sensitivity.residual.leftCols<3>();
  Equilibrium equilibrium;
  // Subtracted from zero, so that a zero is 0 and not -0.
  equilibrium.force = Eigen::Vector3d::Zero() - newton.residual.tool;
  equilibrium.stiffness = Eigen::Matrix3d::Zero() - 0.5 * (K + K.transpose());
  equilibrium.energy = newton.residual.energy;
  equilibrium.min_det_F = newton.residual.min_det_F;
  if (here.right_hand_sides.cols() >= 6) {
    setDrive(newton.state, here.right_hand_sides.middleCols<3>(3), here.sensitivity, equilibrium);
    setThirdDerivatives(system_, newton.state, here.sensitivity.solution.leftCols<6>(), *finger_,
                        equilibrium);
  }
  return equilibrium;
}

/// Returns the derivatives of the energy with respect to the displacement h and the place t of the
/// hold. They follow from dE/dh = multiplier of the hold, as those of setDrive().
Held TransitionSolver::heldAt(const State& state, const Linearization& here) const {
  const auto r = here.right_hand_sides.rightCols<6>(),
             by_hold = here.sensitivity.solution.rightCols<6>();
  Matrix6d stiffness = r.transpose() * by_hold;
  stiffness.bottomRightCorner<3, 3>() += curvatureByPlace(*hold_, state, state.held_multiplier);
  Held held = {.at = {hold_->place, state.held_displacement},
               .stiffness = 0.5 * (stiffness + stiffness.transpose()),
               .hand_by_hold = here.right_hand_sides.leftCols<6>().transpose() * by_hold};
  held.force << -state.held_multiplier,
      r.block<3, 3>(system_.unknowns(), 3).transpose() * state.held_multiplier;
  return held;
}

/// Makes the state to which Newton converged the end of `step`. Returns Cause::none, or why the
/// state is rejected.
Cause TransitionSolver::accept(NewtonResult& newton, Use use, Step& step) {
  Linearization here;
  if (const Cause cause = judge(newton, use, here); cause != Cause::none) return cause;
  step.equilibrium = equilibriumAt(newton, here);
  if (!isUsable(step.equilibrium)) return Cause::not_finite;
  step.end = {std::move(newton.state), here.sensitivity.solution.leftCols<3>(),
              -step.equilibrium.force};
  if (use != Use::passed && finger_) {
    step.end.sensitivity_by_place = here.sensitivity.solution.middleCols<3>(3);
    step.end.place = finger_->place;
    if (hold_) {
      step.held = heldAt(step.end.state, here);
      step.end.sensitivity_by_hold = here.sensitivity.solution.rightCols<6>();
      step.end.hold_place = hold_->place;
    }
  }
  return Cause::none;
}

/// Moves the tool from its position in `from` to `displacement` in one step. Newton may use at most
/// `factorizations` factorisations. `last`: this step ends the transition, with full precision.
TransitionSolver::Step TransitionSolver::step(const Start& from,
                                              const Eigen::Vector3d& displacement, bool last,
                                              int factorizations) {
  NewtonOptions options = last ? options_.newton : loosened(options_.newton);
  options.max_factorizations = std::min(options.max_factorizations, factorizations);
  return solveFrom(approach(from, displacement), displacement, last ? Use::stored : Use::passed,
                   options);
}

/// Solves for the equilibrium near `state`. If none is accepted, Step::failure gives the reason.
TransitionSolver::Step TransitionSolver::solveFrom(State state, const Eigen::Vector3d& displacement,
                                                   Use use, const NewtonOptions& options) {
  NewtonResult newton = findEquilibrium(system_, solver_, std::move(state), displacement, options);
  Step step;
  step.easy = newton.factorizations <= options_.easy_factorizations;
  const Cause cause = newton.cause == Cause::none ? accept(newton, use, step) : newton.cause;
  step.failure = failureOf(cause, newton);
  if (cause == Cause::wrong_inertia) {
    step.failure.expected_negative_pivots = system_.expectedNegativePivots().value_or(0);
    step.end.state = std::move(newton.state);
  }
  step.cost = {newton.iterations, newton.factorizations, cause == Cause::none ? 1 : 0};
  return step;
}

/// Finds a stable equilibrium near the unstable one at the end of `before`, which lies beyond a
/// bifurcation.
///
/// Newton starts from displacements along the critical mode, to both sides, and farther in each
/// round. If both sides lead to a solution, the one with the lower energy is taken. If the two are
/// symmetric twins, the one on the side where the mode's largest component is positive is taken.
/// `way`: metres that the tool has moved since the branch was stable. Fails with Cause::bifurcation
/// if no stable equilibrium is found.
TransitionSolver::Step TransitionSolver::stepAside(const Step& before, double way, bool last) {
  PALPATE_ASSERT(isUnstable(before.failure), "only an unstable body has a buckling mode");
  const State& unstable = before.end.state;
  std::optional<Step> found;
  Cost cost = {.factorizations = 1};
  const auto mode = criticalMode(system_, solver_, unstable);
  NewtonOptions options = options_.newton;
  options.max_factorizations = std::max(options.max_factorizations, aside_factorizations);
  // The amplitude of the mode grows with the square root of the distance beyond a bifurcation.
  const double unit = std::sqrt(system_.meanEdge() * way);
  for (double size = 1; mode && !found && size <= widest_step_aside; size *= 2)
    for (const double side : {1.0, -1.0}) {
      NewtonResult newton =
          findEquilibrium(system_, solver_,
                          system_.moved(unstable, *mode, side * size * unit, unstable.displacement),
                          unstable.displacement, options);
      Step step;
      const bool stable = newton.cause == Cause::none && newton.factorizations > 0 &&
                          accept(newton, last ? Use::stored : Use::passed, step) == Cause::none;
      cost += {newton.iterations, newton.factorizations, 0};
      if (!stable) continue;
      step.failure.residual = newton.residual.norm;
      const double energy = step.equilibrium.energy;
      if (!found || energy < found->equilibrium.energy - twin_energy * std::abs(energy))
        found = std::move(step);
    }
  if (!found) {
    found = before;
    found->failure.cause = Cause::bifurcation;
  }
  found->cost = cost;
  found->cost.steps = found->failure.cause == Cause::none ? 1 : 0;
  return std::move(*found);
}

/// Adds the nodal fields of the configuration that a transition reached.
void TransitionSolver::setFields(const State& state, const Eigen::Vector3d& target,
                                 Configuration& reached) const {
  const Equilibrium& end = reached.equilibrium;
  PALPATE_ASSERT(isUsable(end), "the results must be finite and not too large");
  PALPATE_ASSERT(!problem_.scene.workspace.reject_inverted || end.min_det_F > 0,
                 "this scene allows no inverted elements");
  PALPATE_ASSERT(state.displacement == target, "a configuration must lie at its target");
  reached.fields.displacement.assign(state.u.begin(), state.u.end());
  reached.fields.pressure.reserve(state.q.size());
  for (const double q : state.q)
    reached.fields.pressure.push_back(static_cast<float>(q * system_.pressureScale()));
}

Reached TransitionSolver::reach(const Start& start, const Eigen::Vector3d& target) {
  PALPATE_ASSERT(start.sensitivity.rows() == system_.unknowns() + system_.multipliers(),
                 "the start must be prepared for the current tool");
  const double began = threadSeconds();
  Reached reached;
  Cost& cost = reached.outcome.cost;
  const Eigen::Vector3d origin = start.state.displacement, whole = target - origin;
  const Start* from = &start;
  double at = 0, length = 1;     // fractions of the whole movement
  std::optional<Step> unstable;  // last step to an unstable equilibrium, at unstable_at
  double unstable_at = 1;
  int budget = options_.max_factorizations;
  bool stepped_aside = false;
  const bool gives_up = givesUp(start, whole);
  if (gives_up) reached.outcome.end = Failure{.cause = Cause::beyond_force};
  while (at < 1 && !gives_up) {
    double next = std::min(1.0, at + length);
    Step tried = step(*from, next == 1 ? target : Eigen::Vector3d(origin + next * whole), next == 1,
                      budget - cost.factorizations);
    cost += tried.cost;
    if (isUnstable(tried.failure)) {
      unstable = tried;
      unstable_at = next;
    }
    const auto isSpent = [&] {
      return (next - at) / 2 < options_.smallest_step || cost.factorizations >= budget;
    };
    if (tried.failure.cause != Cause::none && isSpent() && unstable && !stepped_aside) {
      stepped_aside = true;
      next = unstable_at;
      tried = stepAside(*unstable, (next - at) * whole.norm(), next == 1);
      cost += tried.cost;
      budget = cost.factorizations + options_.max_factorizations;
    }
    if (tried.failure.cause == Cause::none) {
      reached.outcome.end = Configuration{tried.equilibrium, tried.failure.residual, {}};
      reached.end = std::move(tried.end);
      reached.held = tried.held;
      from = &*reached.end;
      at = next;
      if (at >= unstable_at) unstable.reset();
      if (tried.easy) length *= 2;
    } else {
      length = (next - at) / 2;
    }
    if (at < 1 && reached.end && isTooStrong(reached.end->exerted)) {
      reached.outcome.end = Failure{.cause = Cause::beyond_force, .step_reached = at};
      break;
    }
    const bool is_split = tried.failure.cause == Cause::bifurcation;
    const bool too_small = length < options_.smallest_step;
    const bool too_costly = cost.factorizations >= budget;
    if (at < 1 && (is_split || too_small || too_costly)) {
      tried.failure.step_reached = at;
      if (!is_split && !too_small) tried.failure.cause = Cause::step_budget;
      reached.outcome.end = tried.failure;
      break;
    }
  }
  PALPATE_ASSERT(reached.outcome.converged() == (at >= 1), "a path must reach its end or fail");
  if (at >= 1) setFields(reached.end->state, target, reached.outcome.configuration());
  cost.seconds = threadSeconds() - began;
  return reached;
}

std::optional<Start> TransitionSolver::hold(const Start& end, const Finger& second,
                                            Failure& failure) {
  PALPATE_ASSERT(finger_ && !hold_, "only one finger can hold the body");
  State state = end.state;
  state.held_displacement = state.displacement;
  state.held_multiplier = state.multiplier;
  const Tool holding = tool_;
  const PlacedFinger first = *finger_;
  placeFinger("the second finger", second);
  system_.hold(holding);
  hold_ = first;
  state.displacement.setZero();
  state.multiplier.setZero();
  for (std::size_t n = 0; n < tool_.nodes.size(); ++n)
    state.displacement += tool_.weights[n] * (ofNode(state.u, at(tool_.nodes[n])) -
                                              ofNode(system_.restState().u, at(tool_.nodes[n])));
  return linearize(std::move(state), failure);
}

void TransitionSolver::letGo() {
  system_.hold(std::nullopt);
  hold_.reset();
}

/// Moves the hold to the place of `finger`.
void TransitionSolver::moveHold(const Finger& finger) {
  if (hold_->place == finger.center) return;
  hold_ = placed("the hold", finger);
  system_.hold(Tool{hold_->nodes, hold_->weights});
}

Reached TransitionSolver::follow(const Start& start, const Finger& finger,
                                 const Eigen::Vector3d& target, const Hold& hold) {
  PALPATE_ASSERT(start.sensitivity_by_place.cols() == 3,
                 "the start must have derivatives with respect to the finger's place");
  const double began = threadSeconds();
  const Eigen::Vector3d way = target - start.state.displacement,
                        slide = finger.center - start.place,
                        held_way = hold.displacement - start.state.held_displacement;
  Reached reached;
  Cost& cost = reached.outcome.cost;
  const Start* from = &start;
  double at = 0, length = 1;  // fractions of the whole movement
  while (at < 1 && length >= options_.smallest_step) {
    const double next = std::min(1.0, at + length);
    const bool last = next == 1;
    Finger moved = finger;
    if (!last) moved.center = start.place + next * slide;
    placeFinger("finger", moved);
    const Eigen::Vector3d p =
        last ? target : Eigen::Vector3d(start.state.displacement + next * way);
    Eigen::VectorXd predictor = from->sensitivity * (p - from->state.displacement) +
                                from->sensitivity_by_place * (moved.center - from->place);
    State begun = from->state;
    if (hold_) {
      begun.held_displacement = start.state.held_displacement + next * held_way;
      moveHold({last ? hold.place
                     : Eigen::Vector3d(start.hold_place + next * (hold.place - start.hold_place)),
                finger.radius});
      Vector6d held;
      held << begun.held_displacement - from->state.held_displacement,
          hold_->place - from->hold_place;
      predictor += from->sensitivity_by_hold * held;
    }
    NewtonOptions options = loosened(options_.newton);
    options.begin_with_old_factors = solver_.useFactorsWith(system_.border());
    Step tried = solveFrom(system_.moved(begun, predictor, 1, p), p, Use::felt, options);
    cost += tried.cost;
    if (tried.failure.cause == Cause::none) {
      reached.outcome.end = Configuration{tried.equilibrium, tried.failure.residual, {}};
      reached.end = std::move(tried.end);
      reached.held = tried.held;
      from = &*reached.end;
      at = next;
    } else {
      tried.failure.step_reached = at;
      reached.outcome.end = tried.failure;
      length = (next - at) / 2;
    }
  }
  if (at >= 1) setFields(reached.end->state, target, reached.outcome.configuration());
  cost.seconds = threadSeconds() - began;
  return reached;
}

}  // namespace palpate
