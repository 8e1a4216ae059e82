#include "worker/solver/body_model.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "tests/support/body_models.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/problems.hpp"

namespace palpate {
namespace {

using Field = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

BodyModel box(DisplacementSpace displacement) {
  Material material = test::materialOf(LawName::neo_hookean);
  material.density = 1050;
  return test::freeBody(test::distortedBoxMesh({0.2, 0.1, 0.3}, {2, 1, 2}),
                        {displacement, PressureSpace::none, Constraint::ln_det_F}, material);
}

/// Work of the loads on a displacement field in the finite-element space.
double work(const BodyModel& model, const Field& u) {
  double sum = 0;
  for (std::size_t node = 0; node < model.mesh.nodes.size(); ++node)
    sum += Eigen::Map<const Eigen::Vector3d>(&model.load[3 * node]).dot(u(model.mesh.nodes[node]));
  return sum;
}

TEST(BodyModel, ATractionIsIntegratedExactlyForTheElements) {
  for (const DisplacementSpace space : {DisplacementSpace::p1, DisplacementSpace::p2}) {
    BodyModel model = box(space);
    addTraction(model, test::facesOf(model.mesh, "xmax"), {100, 0, 7});
    // Over y in 0..0.1 and z in 0..0.3 at x = 0.2: integral of y is 0.0015, of z^2 0.0009, of yz
    // 0.000225.
    EXPECT_NEAR(work(model, [](auto&) { return Eigen::Vector3d(1, 1, 1); }), 107 * 0.03, 1e-12);
    EXPECT_NEAR(work(model, [](auto& x) { return Eigen::Vector3d(x[1], 0, 0); }), 100 * 0.0015,
                1e-12);
    if (space == DisplacementSpace::p2) {
      EXPECT_NEAR(work(model, [](auto& x) { return Eigen::Vector3d(x[2] * x[2], 0, x[1] * x[2]); }),
                  100 * 0.0009 + 7 * 0.000225, 1e-12);
    }
  }
}

TEST(BodyModel, GravityIsIntegratedExactlyForTheElements) {
  for (const DisplacementSpace space : {DisplacementSpace::p1, DisplacementSpace::p2}) {
    BodyModel model = box(space);
    addGravity(model, {0, 0, -10});
    const double weight = 1050 * 10 * 0.2 * 0.1 * 0.3;
    EXPECT_NEAR(work(model, [](auto&) { return Eigen::Vector3d(5, 3, 1); }), -weight, 1e-9);
    EXPECT_NEAR(work(model, [](auto& x) { return Eigen::Vector3d(0, 0, x[2]); }), -weight * 0.15,
                1e-9);
    if (space == DisplacementSpace::p2) {
      EXPECT_NEAR(work(model, [](auto& x) { return Eigen::Vector3d(0, 0, x[2] * x[2]); }),
                  -weight * 0.03, 1e-9);
    }
  }
}

TEST(BodyModel, GravityNeedsADensity) {
  BodyModel model = box(DisplacementSpace::p1);
  model.materials[0].density.reset();
  test::expectBadInput([&] { addGravity(model, {0, 0, -10}); }, {"density"});
}

TEST(BodyModel, MatchesTheProblem) {
  Scene scene = test::mooneyRivlinScene();
  scene.regions[0].material.density = 1000;
  scene.gravity = {0, -9.81, 0};
  const Problem problem =
      test::clampedProblem(scene, test::boxMesh({0.2, 0.1, 0.1}, {3, 2, 2}), {0.2, 0.1, 0.1}, 0.06);
  const BodyModel model = bodyModel(problem);
  ASSERT_EQ(model.tools.size(), 1u);
  EXPECT_EQ(model.tools[0].nodes, problem.active[0].nodes);
  EXPECT_TRUE(model.tools[0].weights.empty());
  for (std::size_t node = 0; node < problem.mesh.nodes.size(); ++node) {
    const bool fixed = std::binary_search(problem.fixed.begin(), problem.fixed.end(), node);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(model.fixed[3 * node + i], fixed);
  }
  EXPECT_NEAR(work(model, [](auto&) { return Eigen::Vector3d(0, 1, 0); }), -9.81 * 1000 * 0.002,
              1e-9);
}

}  // namespace
}  // namespace palpate
