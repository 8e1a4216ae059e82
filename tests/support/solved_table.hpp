#pragma once

#include <cmath>
#include <string>
#include <utility>

#include "common/problem/problem.hpp"
#include "common/wire/wire.hpp"
#include "tests/support/meshes.hpp"

/// A problem whose transitions are solved by looking them up, for tests of those who hand them out.
namespace palpate::test {

/// A small cube with two active nodes and 33 lattice points around each.
inline Problem cubeProblem(double c10 = 1300) {
  Scene scene;
  scene.name = "cube";
  scene.mesh = "cube.msh";
  scene.regions[0].material.c10 = c10;
  scene.regions[0].material.c01 = 1280;
  scene.fixed.half_spaces = {{0, true, 0.15, std::nullopt}};
  scene.active = {{"tip", Eigen::Vector3d(0.1, 0.05, 0.05), std::nullopt, 0},
                  {"corner", Eigen::Vector3d(0.1, 0.1, 0.1), std::nullopt, 0}};
  scene.workspace = {0.02, 0.01, 8.5, true};
  return resolve(scene, cubeMesh(0.1, 2));
}

/// What a worker would answer: a pure function of the transition. About a quarter of the
/// transitions fail and some points lie beyond max_force. Forces of neighbours contradict each
/// other, so that branches are looked for.
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
  outcome.converged = origin || dice % 100 >= 25;
  if (outcome.converged) {
    const double norm = std::sqrt(static_cast<double>(squaredNorm(target)));
    outcome.equilibrium.force = {-3 * norm - 0.1 * static_cast<double>(dice % 40), 0.5,
                                 1e-3 / (1 + norm)};
    outcome.equilibrium.energy =
        norm + 0.01 * static_cast<double>(dice % 7);  // another branch, another energy
    const std::size_t nodes = problem.mesh.nodes.size();
    for (std::size_t n = 0; n < 3 * nodes; ++n)
      outcome.fields.displacement.push_back(static_cast<float>(dice % 1000) +
                                            static_cast<float>(n));
    outcome.fields.pressure.assign(nodes, static_cast<float>(dice % 77));
  } else {
    outcome.failure.cause = static_cast<Cause>(1 + dice % 7);
    outcome.failure.step_reached = static_cast<double>(dice % 11) / 11;
    outcome.failure.residual = dice % 2 == 0 ? std::nan("") : 1;
  }
  wire::Result result;
  result.set_build(std::string(problemId(problem).bytes()));
  result.set_space(space);
  *result.mutable_target() = toWire(target);
  *result.mutable_parent() = toWire(parent);
  result.set_kernel_family("baseline");
  const std::string payload = outcome.converged ? outcome.fields.encode() : std::string();
  toWire(outcome, payload, result);
  return {result, payload};
}

}  // namespace palpate::test
