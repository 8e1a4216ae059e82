#include "scheduler/service/result_check.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

/// Largest relative residual. The solver stops at 1e-9 of the force on the tool, and 1e-10 of the
/// force that shears an element (NewtonOptions). A result with a thousand times this residual does
/// not come from this solver.
constexpr double largest_residual = 1e-6;
/// Tolerance of a displacement, relative to its size. Fields are float32, and the nodes of a
/// weighted tool have the prescribed displacement only on average.
constexpr double place_tolerance = 1e-4;
constexpr double odd_force = 0.05, odd_energy = 0.003;
/// Limit on iterations and steps: far more than any transition needs.
constexpr std::int32_t most_steps = 1'000'000;

bool isPlausible(const Cost& cost) {
  const auto counts = {cost.newton_iterations, cost.factorizations, cost.steps};
  return std::ranges::all_of(counts, [](auto n) { return n >= 0 && n <= most_steps; }) &&
         std::isfinite(cost.seconds) && cost.seconds >= 0;
}

std::string objectionToFailure(const Failure& failure, const Mesh& mesh) {
  if (!(failure.step_reached >= 0 && failure.step_reached <= 1))
    return "a failure whose step_reached is not between 0 and 1";
  if (failure.element < -1 || failure.element >= std::ssize(mesh.tetrahedra))
    return "a failure in an element that does not exist";
  if (failure.negative_pivots < 0 || failure.expected_negative_pivots < 0)
    return "a failure with a negative number of pivots";
  return "";
}

Eigen::Vector3d displacementOf(const NodalFields& fields, std::int32_t node) {
  const float* const u = &fields.displacement[3 * at(node)];
  return {u[0], u[1], u[2]};
}

/// Returns the displacement of the tool, the weighted mean over its nodes.
Eigen::Vector3d displacementOf(const NodalFields& fields, const ActivePatch& patch) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t n = 0; n < patch.nodes.size(); ++n)
    mean += patch.weights[n] * displacementOf(fields, patch.nodes[n]);
  return mean;
}

bool isSymmetric(const Eigen::Matrix3d& matrix) { return matrix == matrix.transpose(); }

}  // namespace

ResultCheck::ResultCheck(const Problem& problem, const ContentId& build)
    : problem_(&problem),
      build_(build),
      lattice_(uniformLattice(problem.scene)),
      diameter_(boundingBox(problem.mesh).diagonal().norm()) {}

ResultCheck::Judged ResultCheck::judge(const wire::Result& result, const std::string& payload,
                                       const std::string& kernel_family) const {
  std::optional<Outcome> outcome = fromWire(result);
  if (!outcome) return {"an invalid result", {}};
  std::string objection = objectionTo(result, *outcome, payload, kernel_family);
  return {std::move(objection), std::move(*outcome)};
}

std::string ResultCheck::objectionTo(const wire::Result& result, const Outcome& outcome,
                                     const std::string& payload,
                                     const std::string& kernel_family) const {
  if (result.build() != build_.bytes()) return "a result of another build";
  if (result.payload_bytes() != payload.size())
    return "a result whose payload differs in length from its header";
  if (result.kernel_family() != kernel_family) return "a result of another kernel family";
  if (result.space() >= problem_->active.size()) return "a result of a space that does not exist";
  if (!isPlausible(outcome.cost)) return "a result with impossible costs";
  if (!outcome.converged()) {
    if (!payload.empty() || !result.fields_id().empty()) return "a failure with nodal fields";
    // Check the failure's step: it is shown to users and decides which cause the point gets.
    return objectionToFailure(outcome.failure(), problem_->mesh);
  }
  if (ContentId::of(payload).bytes() != result.fields_id())
    return "a result whose payload does not match its content id";
  try {
    return objectionTo(
        result, outcome,
        NodalFields::decode(payload, problem_->mesh.nodes.size(), problem_->pressures.count()));
  } catch (const Error& error) {
    return error.what();
  }
}

std::string ResultCheck::objectionTo(const wire::Result& result, const Outcome& outcome,
                                     const NodalFields& fields) const {
  const Equilibrium& e = outcome.equilibrium();
  const double residual = outcome.configuration().residual;
  const ActivePatch& patch = problem_->active[result.space()];
  const Scene& scene = problem_->scene;
  if (scene.workspace.reject_inverted && !(e.min_det_F > 0)) return "an inverted element";
  const double force_scale = e.force.norm() + e.stiffness.norm() * diameter_;
  if (!(residual >= 0 && residual <= largest_residual * force_scale))
    return "a residual that is invalid or too large for an equilibrium";
  if (!isSymmetric(e.stiffness) || !isSymmetric(e.drive_slope))
    return "a stiffness or drive slope that is not symmetric";
  if (hasDrive(e) && !patch.finger) return "a configurational force without a finger";
  for (const std::int32_t node : problem_->fixed)
    if (!displacementOf(fields, node).isZero(0)) return "a fixed node that moved";

  // Under gravity, the tool starts from a rest position that only solvers know, so its displacement
  // cannot be checked here.
  if (!scene.gravity.isZero()) return "";
  const Eigen::Vector3d p = lattice_.displacementOf(fromWire(result.target()));
  const double tolerance = place_tolerance * std::max(p.norm(), 1e-3 * scene.workspace.spacing);
  const auto isThere = [&](const Eigen::Vector3d& u) { return (u - p).norm() <= tolerance; };
  const bool there = patch.weights.empty()
                         ? std::ranges::all_of(patch.nodes,
                                               [&](std::int32_t node) {
                                                 return isThere(displacementOf(fields, node));
                                               })
                         : isThere(displacementOf(fields, patch));
  if (!there) return "a tool that does not have the requested displacement";
  // An origin that was solved from a neighbour is at rest only up to rounding.
  if (fromWire(result.target()) != fromWire(result.parent())) return "";
  if (!std::ranges::all_of(fields.displacement, [](float u) { return u == 0; }) ||
      !e.force.isZero(0) || e.energy != 0)
    return "a nonzero rest state";
  const Eigen::LLT<Eigen::Matrix3d> factors(-e.stiffness);
  return factors.info() == Eigen::Success ? "" : "an unstable rest state";
}

std::string ResultCheck::reproducibleBytes(wire::Result result) {
  // Lease, giver and duration depend on timing; steps and start_parent are added by the scheduler.
  // Everything else follows from the scene. Unknown fields (job and attempt) come from older
  // records and depend on timing too.
  result.GetReflection()->MutableUnknownFields(&result)->Clear();
  result.clear_lease();
  result.clear_given_by();
  result.clear_steps();
  result.clear_start_parent();
  if (result.has_cost()) result.mutable_cost()->clear_seconds();
  return result.SerializeAsString();
}

bool ResultCheck::agree(const wire::Result& first, const wire::Result& second) {
  return reproducibleBytes(first) == reproducibleBytes(second);
}

double oddnessBeside(const ToolEquilibrium& parent, const ToolEquilibrium& found,
                     const Eigen::Vector3d& way) {
  const double force = parent.force.norm() + found.force.norm();
  const double work = -(parent.force + found.force).dot(way) / 2 +
                      way.dot((found.stiffness - parent.stiffness) * way) / 12;
  const Eigen::Vector3d rise = (parent.stiffness + found.stiffness) * way / 2;
  const double by_energy =
      std::abs(found.energy - parent.energy - work) / (odd_energy * force * way.norm() / 2);
  const double by_force = (found.force - parent.force - rise).norm() / (odd_force * force);
  const double oddness = std::max(by_energy, by_force);
  // If both forces are zero, both ratios are 0/0. The result then counts as odd.
  return std::isnan(oddness) ? std::numeric_limits<double>::infinity() : oddness;
}

}  // namespace palpate
