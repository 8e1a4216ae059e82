#include "worker/solver/local_relaxation.hpp"

#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "worker/solver/newton.hpp"

namespace palpate {
namespace {

constexpr int max_iterations = 12;
constexpr int max_halvings = 6;

}  // namespace

bool relaxNearTool(const System& system, const Neighborhood& neighborhood, State& state,
                   double tolerance) {
  State now = state;
  Eigen::VectorXd residual, trial_residual, whole_step = Eigen::VectorXd::Zero(system.unknowns());
  Eigen::MatrixXd tangent, trial_tangent;
  system.assemble(now, neighborhood, residual, tangent);
  for (int iteration = 0; residual.norm() > tolerance; ++iteration) {
    if (iteration == max_iterations) return false;
    whole_step(neighborhood.unknowns) = -tangent.partialPivLu().solve(residual);
    bool descended = false;
    double factor = 1;
    for (int halvings = 0; !descended && halvings <= max_halvings; ++halvings, factor /= 2) {
      State next = system.moved(now, whole_step, factor, state.displacement);
      system.assemble(next, neighborhood, trial_residual, trial_tangent);
      descended = trial_residual.norm() <= (1 - sufficient_decrease * factor) * residual.norm();
      if (descended) now = std::move(next);
    }
    if (!descended) return false;
    residual.swap(trial_residual);
    tangent.swap(trial_tangent);
  }
  if (!residual.allFinite()) return false;
  state = std::move(now);
  return true;
}

}  // namespace palpate
