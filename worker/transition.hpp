#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/configuration.hpp"
#include "common/problem.hpp"
#include "worker/kernel_family.hpp"
#include "worker/linear_solver.hpp"
#include "worker/newton.hpp"
#include "worker/system.hpp"

namespace palpate {

struct TransitionOptions {
  NewtonOptions newton;
  double smallest_step = 1.0 / 16;  ///< fraction of the transition
  int easy_iterations = 4;          ///< a step that took no more is followed by one twice as long
  /// A lattice transition takes about 6 factorisations; one that fails may cost about five times that, no
  /// more.
  int max_factorizations = 32;
};

/// A configuration that transitions start from: where it is, and its tangent predictor.
struct Start {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< of the tool, metres
  State state;
  Eigen::MatrixXd sensitivity;  ///< du/dp over the unknowns, nUnknowns x 3: K_ff S = -K_fa
};

/// An outcome, and when it converged, the configuration to go on from (in double precision).
struct Reached {
  Outcome outcome;
  Start end;
};

/// Solves the configurations of one problem. One per process (it owns the LinearSolver), one thread.
class TransitionSolver {
 public:
  /// `problem` must outlive it. Analyses the sparsity pattern, once for all spaces. Error when that fails.
  TransitionSolver(const Problem& problem, const ElementKernels& kernels, TransitionOptions options = {});

  const System& system() const { return system_; }
  void chooseTool(std::size_t space) { system_.chooseTool(space); }

  /// The rest state, or the configuration with these nodal fields at `displacement`, made ready to start
  /// from: one factorisation, shared by all targets around it. Nothing when MUMPS fails there or a value is
  /// not finite; `failure` then says why.
  std::optional<Start> startAtRest(Failure& failure);
  std::optional<Start> startFrom(const NodalFields& fields, const Eigen::Vector3d& displacement,
                                 Failure& failure);

  /// Moves the tool from `start` to `target` (metres), in steps: tangent predictor, Newton, check, and half
  /// the step when it failed. A state is accepted when it is finite, min det F > 0 (if the scene says so) and
  /// the tangent has the right inertia.
  ///
  /// Outcome::cost counts what this transition took, the factorisation of `start` excepted (it is shared).
  Reached reach(const Start& start, const Eigen::Vector3d& target);

 private:
  bool accept(NewtonResult& newton, const Eigen::Vector3d& displacement, Reached& reached, Failure& failure);
  std::optional<Start> linearize(State state, const Eigen::Vector3d& displacement, Failure& failure);
  NodalFields fieldsOf(const State& state) const;

  const Problem& problem_;
  TransitionOptions options_;
  System system_;
  LinearSolver solver_;
};

}  // namespace palpate
