#include <gtest/gtest.h>

#include <numeric>

#include "common/base/error.hpp"
#include "common/mesh/surface_point.hpp"
#include "common/problem/finger.hpp"
#include "common/problem/problem.hpp"
#include "common/problem/sites.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/meshes.hpp"

namespace palpate {
namespace {

/// A cube of 20 cm with fixed side xmin, touched by a finger of 3 cm that moves 2 cm.
struct ProbePlacesOnACube : ::testing::Test {
  std::vector<ProbePlace> places(ContactMode contact, std::int32_t count) const {
    std::vector<std::int32_t> triangles(mesh.surface.size());
    std::iota(triangles.begin(), triangles.end(), 0);
    return probePlaces(mesh, triangles, fixed, 0.03, 0.02, contact, count);
  }
  Mesh mesh = test::cubeMesh(0.2, 6);
  const NodeSet& fixed = mesh.node_groups.at("xmin");
};

TEST_F(ProbePlacesOnACube, LieOnTheSurfaceAndPushInward) {
  for (const auto& [place, displacement] : places(ContactMode::unilateral, 100)) {
    EXPECT_LT((positionOf(mesh, nearestOnSurface(mesh, place)) - place).norm(), 1e-12);
    EXPECT_GE(fingerWeights(mesh, fixed, place, 0.03).free_share, least_free_share);
    EXPECT_LE(displacement.norm(), 0.02);
    EXPECT_GE(displacement.norm(), 0.0002) << "not at rest";
    const Eigen::Vector3d normal = normalOf(mesh, nearestOnSurface(mesh, place).triangle);
    EXPECT_LE(displacement.dot(normal), -0.2588 * displacement.norm());
    EXPECT_TRUE(pushedAround(mesh, {place, 0.03}).contains(displacement));
  }
}

TEST_F(ProbePlacesOnACube, FillSurfaceLengthsAndDirectionsEvenly) {
  constexpr std::int32_t count = 600;
  const auto found = places(ContactMode::glued, count);
  ASSERT_EQ(found.size(), 600u);
  std::array<int, 2> sides = {};  // ymin and ymax: each has a good sixth of the free surface
  int inner = 0, up = 0;
  for (const auto& [place, displacement] : found) {
    if (place.y() < 1e-9) ++sides[0];
    if (place.y() > 0.2 - 1e-9) ++sides[1];
    inner += displacement.norm() < 0.01;
    up += displacement.z() > 0;
  }
  for (const int side : sides) EXPECT_NEAR(side, count / 5.3, 12);
  EXPECT_NEAR(inner, count / 2.0, 12);
  EXPECT_NEAR(up, count / 2.0, 12);
}

TEST_F(ProbePlacesOnACube, AreReproducibleAndFewerAreAPrefix) {
  const auto many = places(ContactMode::unilateral, 20), few = places(ContactMode::unilateral, 5);
  ASSERT_EQ(few.size(), 5u);
  for (std::size_t n = 0; n < few.size(); ++n) {
    EXPECT_EQ(few[n].place, many[n].place);
    EXPECT_EQ(few[n].displacement, many[n].displacement);
  }
}

TEST_F(ProbePlacesOnACube, AreEmptyIfNoFingerCanStand) {
  std::vector<std::int32_t> held;
  for (std::size_t t = 0; t < mesh.surface.size(); ++t)
    if (std::ranges::all_of(mesh.surface[t], [&](auto node) { return contains(fixed, node); }))
      held.push_back(static_cast<std::int32_t>(t));
  EXPECT_TRUE(probePlaces(mesh, held, fixed, 0.01, 0.02, ContactMode::unilateral, 10).empty());
}

TEST(ProbePlacesOfAProblem, FollowTheSitesWhichHaveNoProbes) {
  const Problem problem = test::FingerBody(7).problem;
  const std::size_t sites = problem.active.size() - 7;
  for (std::size_t s = 0; s < problem.active.size(); ++s) {
    EXPECT_EQ(problem.active[s].probe.has_value(), s >= sites);
    EXPECT_EQ(probesIn(problem.scene, s), s >= sites ? 1 : 0);
    EXPECT_EQ(problem.active[s].probe, problem.scene.active[s].probe);
  }
  EXPECT_EQ(problem.active.back().name, "top-probe-6");
  EXPECT_EQ(uniformLattice(problem.scene, problem.active.back()).size(), 1);
}

TEST(ProbePlacesOfAProblem, AreSerializedAndPartOfTheId) {
  const Problem problem = test::FingerBody(7).problem;
  const Problem again = decodeProblem(encodeProblem(problem));
  for (std::size_t s = 0; s < problem.active.size(); ++s)
    EXPECT_EQ(again.active[s].probe, problem.active[s].probe);
  EXPECT_EQ(problemId(again), problemId(problem));
  Problem moved = problem;
  *moved.active.back().probe *= 0.5;
  EXPECT_NE(problemId(moved), problemId(problem));
  EXPECT_THROW(checkProblem(moved), Error);  // contradicts the scene
}

}  // namespace
}  // namespace palpate
