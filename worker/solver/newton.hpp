#pragma once

#include "common/space/failure.hpp"
#include "worker/solver/system.hpp"
#include "worker/solver/tangent_solver.hpp"

namespace palpate {

struct NewtonOptions {
  int max_iterations = 40;
  int max_factorizations = 6;
  int max_halvings = 6;  ///< number of halvings of a step by the line search
  /// Whether each iteration factorises a new tangent. Use it for bodies whose stiffness jumps:
  /// Broyden's updates of an old tangent help little there.
  bool renew_always = false;
  /// Whether to begin with the factors that the solver holds. They must be of a tangent near the
  /// start, with the border of the current tool (TangentSolver::useFactorsWith).
  bool begin_with_old_factors = false;
  /// Whether to accept also a step after which the next correction with the same tangent is smaller
  /// (natural monotonicity test; Deuflhard, Newton Methods for Nonlinear Problems, 2004). Needed
  /// for bodies with a nearly rigid part, whose rotation increases the residual.
  bool affine_descent = false;
  /// Unless renew_always, the same tangent is used again after a full step that multiplied the
  /// residual norm by at most this factor.
  double slow_contraction = 0.5;
  /// The same tangent is also used again if convergence at the rate of the last step needs at most
  /// this many more iterations.
  int iterations_worth_a_tangent = 8;
  /// Newton has converged when the residual norm is at most absolute * (System::forceScale() +
  /// totalLoad()) + relative * |force on the tool|, where the force counts at most 1e4 times
  /// forceScale(). The relative error of the force is then about 1e-9.
  double absolute_tolerance = 1e-10;
  double relative_tolerance = 1e-9;
};

/// Returns why the residual of a state is not finite. This is Cause::inverted_element if det F is
/// at most zero somewhere (ln det F does not exist). Otherwise a number overflowed
/// (Cause::not_finite), and det F may be NaN.
Cause causeOfNotFinite(const Residual& residual);

/// The state in which Newton ended, converged or not.
struct NewtonResult {
  Cause cause = Cause::none;  ///< none: converged
  State state;
  Residual residual;            ///< at `state`
  int iterations = 0;           ///< number of corrections of the state
  int factorizations = 0;       ///< number of tangents; `solver` holds the last factors
  Factorization factorization;  ///< report on the factors that were used last
};

/// Solves the equations with the tool at `displacement` (metres). In `start`, the tool must already
/// be there.
///
/// This is a quasi-Newton method. The tangent is factorised at the start, and its inverse is
/// corrected after every step by Broyden's rank-one update (Kelley, Iterative Methods for Linear
/// and Nonlinear Equations, 1995, Sec. 7.3). Slow convergence triggers a new tangent. The first
/// step with a new tangent is Newton's, with a line search that halves the step until the residual
/// norm decreases. The line search uses the residual and not the energy, because with a pressure
/// the solution is a saddle point of the energy.
NewtonResult findEquilibrium(const System& system, TangentSolver& solver, State start,
                             const Eigen::Vector3d& displacement, const NewtonOptions& options);

/// Solves for the nodes around a rigid tool while all other unknowns keep their values in `state`.
///
/// If a tool moves by more than the size of an element, it strains the elements beside it far more
/// than the rest of the body. Newton then needs most of its tangents for these elements, or inverts
/// one of them. Solving the few equations near the tool first is nonlinear elimination (Lanzkron,
/// Rose and Wilkes 1996; Cai and Keyes 2002). The remaining problem of the whole body is smooth,
/// and one tangent suffices.
///
/// Uses Newton's method with a line search and a dense matrix for the neighbourhood. If the
/// residual norm falls to `tolerance` (N), `state` becomes the solution and the result is true.
/// Otherwise `state` is unchanged and the result is false.
bool relaxNearTool(const System& system, const Neighborhood& neighborhood, State& state,
                   double tolerance);

}  // namespace palpate
