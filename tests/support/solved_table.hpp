#pragma once

#include <cmath>
#include <string>
#include <utility>

#include "common/problem/problem.hpp"
#include "common/wire/wire.hpp"
#include "tests/support/meshes.hpp"

/// A problem whose transitions are looked up instead of solved, for tests of the scheduler.
namespace palpate::test {

/// A cube of `cells` cells along an edge, with two active nodes and the lattice points within
/// `radius` (m) around each, 10 mm apart.
inline Problem cubeProblemOf(int cells, double radius, double c10) {
  Scene scene;
  scene.name = "cube";
  scene.mesh = "cube.msh";
  scene.regions[0].material.c10 = c10;
  scene.regions[0].material.c01 = 1280;
  scene.fixed.half_spaces = {{0, true, 0.15, std::nullopt}};
  const double tip = cells > 1 ? 0.05 : 0;
  scene.active = {{"tip", Eigen::Vector3d(0.1, tip, tip), std::nullopt, 0},
                  {"corner", Eigen::Vector3d(0.1, 0.1, 0.1), std::nullopt, 0}};
  scene.workspace = {radius, 0.01, 8.5, true};
  return resolve(scene, cubeMesh(0.1, cells));
}

/// A small cube with two active nodes and 33 lattice points around each.
inline Problem cubeProblem(double c10 = 1300) { return cubeProblemOf(2, 0.02, c10); }

/// Like cubeProblem(), but with 123 points around each node, so that one in a hundred is about one
/// point.
inline Problem wideProblem() { return cubeProblemOf(2, 0.03, 1300); }

/// The smallest such problem: 8 nodes, and 7 lattice points around each of two active nodes.
/// Fuzzers begin a build of it for every input, and sometimes complete it.
inline Problem smallCubeProblem() { return cubeProblemOf(1, 0.01, 1300); }

/// Returns the header and the payload that a worker makes of an outcome.
inline std::pair<wire::Result, std::string> resultOf(const ContentId& build, std::uint32_t space,
                                                     const LatticePoint& target,
                                                     const LatticePoint& parent,
                                                     const Outcome& outcome) {
  wire::Result result;
  result.set_build(std::string(build.bytes()));
  result.set_space(space);
  *result.mutable_target() = toWire(target);
  *result.mutable_parent() = toWire(parent);
  result.set_kernel_family("baseline");
  const std::string payload =
      outcome.converged() ? outcome.configuration().fields.encode() : std::string();
  toWire(outcome, payload, result);
  return {result, payload};
}

/// Fills in the members that a result repeats from its job. They include the number of steps, on
/// which the bits of a result depend.
inline void answer(const wire::Job& job, const wire::Target& target, wire::Result& result) {
  result.set_start_id(job.start_id());
  result.set_lease(target.lease());
  result.mutable_cost()->set_steps(static_cast<std::int32_t>(target.steps()));
}

/// Returns fields with displacement p at the tool's nodes, zero at fixed nodes, and `elsewhere(n)`
/// at any other node n. At rest all are zero.
template <class Elsewhere>
NodalFields fieldsOf(const Problem& problem, std::uint32_t space, const Eigen::Vector3d& p,
                     const Elsewhere& elsewhere) {
  NodalFields fields;
  const auto put = [&](std::size_t node, const Eigen::Vector3d& u) {
    for (std::size_t i = 0; i < 3; ++i)
      fields.displacement[3 * node + i] = static_cast<float>(u[static_cast<Eigen::Index>(i)]);
  };
  fields.displacement.resize(3 * problem.mesh.nodes.size());
  if (p.isZero(0)) return fields;
  for (std::size_t n = 0; n < problem.mesh.nodes.size(); ++n) put(n, elsewhere(n));
  for (const std::int32_t n : problem.fixed)
    put(static_cast<std::size_t>(n), Eigen::Vector3d::Zero());
  for (const std::int32_t n : problem.active.at(space).nodes) put(static_cast<std::size_t>(n), p);
  return fields;
}

/// Returns the answer of a worker, a pure function of the transition. About a quarter of the
/// transitions fail, and some points lie beyond max_force. Forces of neighbours are inconsistent,
/// so that the scheduler looks for branches.
inline std::pair<wire::Result, std::string> solve(const Problem& problem, std::uint32_t space,
                                                  const LatticePoint& target,
                                                  const LatticePoint& parent) {
  std::uint64_t dice = 88172645463325252ull + space;
  for (const LatticePoint& p : {target, parent})
    for (const std::int32_t c : p) {
      dice = (dice ^ static_cast<std::uint64_t>(c + 100)) * 0x9e3779b97f4a7c15ull;
      dice ^= dice >> 29;
    }
  Outcome outcome;
  outcome.cost = {static_cast<std::int32_t>(dice % 9), 3, 2, 0.25};
  const bool origin = target == LatticePoint{};
  if (origin || dice % 100 >= 25) {
    Configuration found;
    const double norm = std::sqrt(static_cast<double>(squaredNorm(target)));
    if (!origin) {
      found.equilibrium.force = {-3 * norm - 0.1 * static_cast<double>(dice % 40), 0.5,
                                 1e-3 / (1 + norm)};
      found.equilibrium.energy =
          norm + 0.01 * static_cast<double>(dice % 7);  // another branch with another energy
    }
    found.equilibrium.stiffness = -50 * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d p = uniformLattice(problem.scene).displacementOf(target);
    found.fields = fieldsOf(problem, space, p, [&](std::size_t n) {
      const auto first = static_cast<double>(dice % 1000 + 3 * n);
      return Eigen::Vector3d(first, first + 1, first + 2);
    });
    found.fields.pressure.assign(problem.mesh.nodes.size(), static_cast<float>(dice % 77));
    outcome.end = std::move(found);
  } else {
    outcome.end = Failure{.cause = static_cast<Cause>(1 + dice % 7),
                          .step_reached = static_cast<double>(dice % 11) / 11,
                          .residual = dice % 2 == 0 ? std::nan("") : 1};
  }
  return resultOf(problemId(problem), space, target, parent, outcome);
}

/// Like solve(), but for a stiffening body, E = k p^2 / 2 + c p^4: everything converges, and each
/// result is consistent with its neighbours.
inline std::pair<wire::Result, std::string> solveSmoothly(const Problem& problem,
                                                          std::uint32_t space,
                                                          const LatticePoint& target,
                                                          const LatticePoint& parent) {
  constexpr double k = 100, c = 2e4;
  const Eigen::Vector3d p = uniformLattice(problem.scene).displacementOf(target);
  const double square = p.squaredNorm();
  Configuration found;
  found.equilibrium.energy = k * square / 2 + c * square * square;
  found.equilibrium.force = Eigen::Vector3d::Zero() - (k + 4 * c * square) * p;
  const Eigen::Matrix3d slope =
      (k + 4 * c * square) * Eigen::Matrix3d::Identity() + 8 * c * p * p.transpose();
  found.equilibrium.stiffness = -(slope + slope.transpose()) / 2;
  found.fields = fieldsOf(problem, space, p, [&](std::size_t n) -> Eigen::Vector3d {
    return p * problem.mesh.nodes[n].x();
  });
  found.fields.pressure.assign(problem.mesh.nodes.size(), static_cast<float>(p.norm()));
  return resultOf(problemId(problem), space, target, parent,
                  {std::move(found), {3 + parent[0], 1, 1, 0.25}});
}

}  // namespace palpate::test
