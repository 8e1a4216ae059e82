#include "worker/solver/dof_map.hpp"

#include <gtest/gtest.h>

#include "tests/support/body_models.hpp"
#include "tests/verification/rig.hpp"
#include "worker/elements/kernel_family.hpp"
#include "worker/solver/tangent_solver.hpp"

namespace palpate {
namespace {

using verification::neoHookean, verification::stabilized, verification::taylor_hood;

/// A cube of 48 elements that stands on one side and leans on another, with one stiffer element:
/// nearly all of its nodes may be fixed or held by the tool.
BodyModel withOneStiff(const Discretization& discretization, std::size_t stiff) {
  BodyModel body = test::freeBody(test::cubeMesh(0.1, 2), discretization, neoHookean(3000));
  body.materials.push_back(neoHookean(30000));
  body.region_of[stiff] = 1;
  test::fix(body, "zmin");
  test::fix(body, "xmin");
  return body;
}

/// Expects as many pressures as the tangent at rest has negative pivots, so that each has an
/// equation.
void expectRegular(const BodyModel& body, std::size_t stiff) {
  const System system(body, chooseKernels());
  TangentSolver solver(system);
  Residual residual;
  Tangent tangent;
  system.assemble(system.restState(), residual, tangent);
  const Factorization factors = solver.factorize(tangent);
  ASSERT_TRUE(factors.ok) << "element " << stiff;
  EXPECT_EQ(factors.negative_pivots, system.expectedNegativePivots()) << "element " << stiff;
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(system.unknowns() + system.multipliers());
  EXPECT_TRUE(solver.solveWith(tangent, ones, 1e-6).has_value()) << "element " << stiff;
}

TEST(DofMap, HasAnEquationForEachPressureInAOneElementRegion) {
  for (const Discretization& discretization : {taylor_hood, stabilized})
    for (std::size_t stiff = 0; stiff < 48; ++stiff)
      expectRegular(withOneStiff(discretization, stiff), stiff);
}

TEST(DofMap, HasAnEquationForEachPressureIfOneMidEdgeNodeMoves) {
  const Mesh mesh = withOneStiff(taylor_hood, 0).mesh;
  std::vector<int> elements_at(mesh.nodes.size(), 0);
  for (const auto& middles : mesh.mid_edge_nodes)
    for (const std::int32_t node : middles) ++elements_at[node];
  int alone = 0;
  for (std::size_t stiff = 0; stiff < 48; ++stiff)
    for (const std::int32_t node : mesh.mid_edge_nodes[stiff]) {
      if (elements_at[node] != 1) continue;
      BodyModel body = withOneStiff(taylor_hood, stiff);
      std::fill(body.fixed.begin(), body.fixed.end(), 1);
      std::fill_n(body.fixed.begin() + 3 * node, 3, 0);
      expectRegular(body, stiff);
      ++alone;
    }
  EXPECT_GT(alone, 4);
}

TEST(DofMap, HasAnEquationForEachPressureIfAToolHoldsARegion) {
  for (const Discretization& discretization : {taylor_hood, stabilized})
    for (std::size_t stiff = 0; stiff < 48; ++stiff) {
      BodyModel body = withOneStiff(discretization, stiff);
      std::fill(body.fixed.begin(), body.fixed.end(), 0);
      test::fix(body, "zmin");
      Tool tool;
      for (std::size_t node = 0; node < body.mesh.nodes.size(); ++node)
        if (body.mesh.nodes[node][2] > 0.049) tool.nodes.push_back(static_cast<std::int32_t>(node));
      body.tools = {tool};
      expectRegular(body, stiff);
    }
}

}  // namespace
}  // namespace palpate
