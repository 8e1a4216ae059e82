#include "common/problem/sites.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>
#include <random>

#include "common/mesh/surface_point.hpp"
#include "common/problem/finger.hpp"
#include "common/problem/problem.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/meshes.hpp"

namespace palpate {
namespace {

std::vector<std::int32_t> allTriangles(const Mesh& mesh) {
  std::vector<std::int32_t> triangles(mesh.surface.size());
  std::iota(triangles.begin(), triangles.end(), 0);
  return triangles;
}

double distanceTo(const std::vector<Eigen::Vector3d>& sites, const Eigen::Vector3d& x) {
  double least = INFINITY;
  for (const Eigen::Vector3d& site : sites) least = std::min(least, (site - x).norm());
  return least;
}

/// A cube of 20 cm with fixed side xmin.
struct SitesOnACube : ::testing::Test {
  static std::vector<Eigen::Vector3d> cover(const Mesh& mesh, double radius) {
    return sitesOn(mesh, allTriangles(mesh), mesh.node_groups.at("xmin"), radius, site_distance);
  }
  /// The sites of a finger of this radius. They are created once, because this takes seconds.
  static const std::vector<Eigen::Vector3d>& covered() {
    static const std::vector<Eigen::Vector3d> sites = cover(mesh, radius);
    return sites;
  }
  static constexpr double radius = 0.03;
  inline static const Mesh mesh = test::cubeMesh(0.2, 6);
};

TEST_F(SitesOnACube, CoverEveryPlaceWhereAFingerCanStand) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(0, 0.2);
  for (int n = 0; n < 100; ++n) {
    Eigen::Vector3d x(number(random), number(random), number(random));
    x[n % 3] = n % 2 == 0 ? 0.2 : 0;
    if (fingerWeights(mesh, mesh.node_groups.at("xmin"), x, radius).free_share < 0.6) continue;
    EXPECT_LT(distanceTo(covered(), x), (site_distance + 0.06) * radius) << x.transpose();
  }
}

TEST_F(SitesOnACube, KeepAMinimumDistance) {
  auto sites = covered();
  while (!sites.empty()) {
    const Eigen::Vector3d site = sites.back();
    sites.pop_back();
    EXPECT_GT(distanceTo(sites, site), 0.6 * site_distance * radius);
  }
}

TEST_F(SitesOnACube, AreCloserAtTheEdgesThanOnTheSides) {
  std::size_t side = 0, edge = 0;
  for (const Eigen::Vector3d& site : covered()) {
    if (site.z() < 0.199) continue;
    const auto inside = [](double x) { return x > 0.05 && x < 0.15; };
    side += inside(site.x()) && inside(site.y());
    edge += inside(site.x()) && site.y() > 0.19;
  }
  // The edge is a strip of a tenth of the side's width.
  EXPECT_GT(10 * edge, 2 * side);
}

TEST_F(SitesOnACube, LieOnTheSurfaceWithEnoughFreeArea) {
  for (const Eigen::Vector3d& site : covered()) {
    EXPECT_LT((positionOf(mesh, nearestOnSurface(mesh, site)) - site).norm(), 1e-14);
    EXPECT_GE(fingerWeights(mesh, mesh.node_groups.at("xmin"), site, 0.03).free_share,
              least_free_share);
  }
}

TEST_F(SitesOnACube, AreEquallyManyOnAFineMesh) {
  const double coarse = static_cast<double>(covered().size());
  const double fine = static_cast<double>(cover(test::cubeMesh(0.2, 18), radius).size());
  EXPECT_NEAR(fine, coarse, 0.1 * coarse);
}

TEST_F(SitesOnACube, AreEmptyIfEverythingIsFixed) {
  EXPECT_TRUE(sitesOn(mesh, allTriangles(mesh), allNodes(mesh), 0.03, site_distance).empty());
}

TEST_F(SitesOnACube, AreRefusedIfTheFingerIsFarTooSmall) {
  test::expectBadInput([&] { cover(mesh, 0.0011); }, {"0.0011 m", "5000 sites", "radius larger"});
}

/// Scenes whose tool is a finger.
struct FingerScene : ::testing::Test {
  FingerScene() {
    scene.name = "fingers";
    scene.mesh = "test.msh";
    scene.regions[0].material = {.law = LawName::mooney_rivlin, .c10 = 1300, .c01 = 1280};
    scene.fixed.groups = {"xmin"};
    scene.active = {{.name = "skin",
                     .radius = 0.05,
                     .tool = ToolKind::finger,
                     .surface = SurfaceSelection{.all = true}}};
  }
  palpate::Problem resolved() const { return resolve(scene, test::cubeMesh(0.2, 4)); }
  void refuses(std::initializer_list<std::string> parts) const {
    test::expectBadInput([&] { resolved(); }, parts);
  }
  Scene scene;
};

TEST_F(FingerScene, ASurfaceBecomesTheSitesOfOneArea) {
  const palpate::Problem problem = resolved();
  ASSERT_GT(problem.active.size(), 50u);
  for (std::size_t n = 0; n < problem.active.size(); ++n) {
    const ActivePatch& patch = problem.active[n];
    EXPECT_EQ(patch.name, "skin-" + std::to_string(n));
    EXPECT_EQ(problem.scene.active[n].area, "skin");
    ASSERT_TRUE(patch.finger);
    EXPECT_LT((patch.finger->center - *problem.scene.active[n].near).norm(), 1e-15);
    EXPECT_EQ(patch.finger->radius, 0.05);
  }
}

TEST_F(FingerScene, RoundTripsAsBytes) {
  const palpate::Problem problem = resolved();
  const palpate::Problem decoded = decodeProblem(encodeProblem(problem));
  EXPECT_EQ(decoded.scene.active.at(3).area, "skin");
  EXPECT_EQ(decoded.active.at(3).finger, problem.active.at(3).finger);
  EXPECT_EQ(decoded.active.at(3).weights, problem.active.at(3).weights);
  EXPECT_EQ(problemId(decoded), problemId(problem));
}

TEST_F(FingerScene, OneFingerStandsAtThePointNearestToNear) {
  scene.active[0].surface.reset();
  scene.active[0].near = Eigen::Vector3d(0.11, 0.07, 0.23);
  const palpate::Problem problem = resolved();
  EXPECT_LT((problem.active.at(0).finger->center - Eigen::Vector3d(0.11, 0.07, 0.2)).norm(), 1e-15);
  EXPECT_TRUE(contains(problem.active[0].nodes, problem.active[0].node));
}

TEST_F(FingerScene, SitesCoverAllTrianglesOfAPartOfTheSurface) {
  scene.active[0].surface = SurfaceSelection{.boxes = {{{0.05, 0.05, 0.15}, {0.2, 0.15, 0.21}}}};
  for (const ActivePatch& patch : resolved().active) {
    EXPECT_GT(patch.finger->center.x(), 0.05);
    EXPECT_GT(patch.finger->center.z(), 0.15);
  }
}

TEST_F(FingerScene, ReachesOnlyPushesUnlessItIsGlued) {
  scene.active[0].radius = 0.03;
  scene.active[0].surface.reset();
  scene.active[0].near = Eigen::Vector3d(0.11, 0.09, 0.2);
  const PushedPart flat = resolved().active[0].finger->reach;
  EXPECT_LT((flat.outward - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(flat.width, 0.045) << "one and a half radii aside";
  EXPECT_NEAR(flat.pull, -std::cos(75 * M_PI / 180), 1e-6) << "the surface is flat under it";
  scene.active[0].near = Eigen::Vector3d(0.2, 0.09, 0.2);
  const PushedPart edge = resolved().active[0].finger->reach;
  EXPECT_NEAR(edge.outward.x(), edge.outward.z(), 0.01);
  // For normals half along x, half along z, a = acos(sqrt(2) - 1).
  EXPECT_NEAR(edge.pull, std::sin(75 * M_PI / 180 - std::asin(std::numbers::sqrt2 - 1)), 0.01)
      << "two sides are under it";
  const ContentId pushing = problemId(resolved());
  scene.contact = ContactMode::glued;
  EXPECT_EQ(resolved().active[0].finger->reach, PushedPart{});
  EXPECT_NE(problemId(resolved()), pushing) << "other configurations";
}

TEST_F(FingerScene, AMillimetreFingerOnALargeBodyIsPlaced) {
  scene.active[0].radius = 0.001;
  scene.active[0].surface.reset();
  scene.active[0].near = Eigen::Vector3d(0.11, 0.09, 0.2);
  EXPECT_EQ(resolved().active.at(0).nodes.size(), 3u) << "of one triangle";
}

TEST_F(FingerScene, IsRefusedWithSettingsThatAFingerCannotHave) {
  scene.active[0].radius = 0.2;
  refuses({"\"skin-0\"", "as wide as the body", "radius smaller"});
  scene.active[0].radius = 0.05;
  scene.active[0].surface = SurfaceSelection{.boxes = {{{-0.1, 0, 0}, {0.01, 0.2, 0.2}}}};
  refuses({"\"skin\": surface", "rest on fixed nodes", "fix fewer"});
  scene.active[0].surface = SurfaceSelection{.boxes = {{{0.19, 0.09, 0.19}, {0.21, 0.11, 0.21}}}};
  refuses({"\"skin\": surface", "contains 1 node ", "triangle"});
  scene.active[0].surface.reset();
  scene.active[0].near = Eigen::Vector3d(0, 0.1, 0.1);
  refuses({"\"skin\"", "contact area", "fixed nodes"});
  scene.active[0].near = Eigen::Vector3d(10, 0.1, 0.1);
  refuses({"\"skin\": near", "more than the body is wide"});
}

TEST(SiteDistance, IsSmallerIfAFingerIndentsDeeply) {
  Scene scene;
  scene.regions[0].material = {.law = LawName::neo_hookean, .mu = 5000};
  scene.workspace = {.radius = 0.03, .spacing = 0.015, .max_force = 3.3};
  EXPECT_EQ(siteDistance(scene, 0.02), site_distance) << "the force limit is reached earlier";
  scene.regions.push_back(scene.regions[0]);
  scene.regions[1].material.mu = 1200;
  EXPECT_NEAR(siteDistance(scene, 0.02), 0.7 * site_distance, 1e-12) << "1.5 radii";
  scene.workspace.radius = 0.02;
  EXPECT_NEAR(siteDistance(scene, 0.02), 0.85 * site_distance, 1e-12);
  scene.workspace.radius = 0.01;
  EXPECT_EQ(siteDistance(scene, 0.02), site_distance) << "shallow";
}

}  // namespace
}  // namespace palpate
