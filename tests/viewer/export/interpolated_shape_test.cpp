#include "viewer/export/interpolated_shape.hpp"

#include <gtest/gtest.h>

#include "tests/support/finger_body.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

struct InterpolatedShapeTest : testing::Test {
  test::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "sample.h5";
};

TEST_F(InterpolatedShapeTest, EqualsTheStoredShapeAtSolvedPointsToTheLastBit) {
  test::SampleDataset sample;
  sample.problem.scene.storage.displacement = StoredNodes::all;
  sample.seal(file);
  const Dataset dataset(file);
  InterpolatedShape shape(dataset, chooseActive(dataset.scene(), "tip"));
  const SpaceTable& tip = dataset.spaces()[0];
  for (std::int32_t n = 0; n < tip.lattice.size(); ++n) {
    if (!interpolatedPoints(tip)[at(n)]) continue;
    const NodalFields found = shape.at(std::nullopt, tip.lattice.displacement(n));
    const NodalFields stored = dataset.fields(0, n);
    EXPECT_EQ(found.displacement, stored.displacement) << n;
    EXPECT_EQ(found.pressure, stored.pressure) << n;
  }
}

TEST_F(InterpolatedShapeTest, LiesHalfWayBetweenTwoConfigurations) {
  test::SampleDataset sample;
  sample.seal(file);
  const Dataset dataset(file);
  InterpolatedShape shape(dataset, chooseActive(dataset.scene(), "edge-2"));
  const NodalFields rest = dataset.fields(1, 0),
                    moved = dataset.fields(1, *dataset.spaces()[1].lattice.indexOf({1, 0, 0})),
                    found = shape.at(std::nullopt, {0.005, 0, 0});
  ASSERT_EQ(found.displacement.size(), rest.displacement.size());
  for (std::size_t i = 0; i < found.displacement.size(); ++i)
    EXPECT_NEAR(found.displacement[i], 0.5 * (rest.displacement[i] + moved.displacement[i]), 1e-8);
  EXPECT_TRUE(found.pressure.empty()) << "the surface alone is stored";
}

/// The body moves with the finger near its place and hardly far away, at sites and between them.
TEST_F(InterpolatedShapeTest, FollowsAFingerBetweenItsSites) {
  const test::FingerBody body;
  body.seal(file);
  const Dataset dataset(file);
  const ActiveChoice choice = chooseActive(dataset.scene(), "top");
  ASSERT_GT(choice.spaces.size(), 3U);
  InterpolatedShape shape(dataset, choice);
  const Vector3d p(0.002, -0.001, -0.008);
  const std::vector<std::int32_t>& stored = dataset.storedNodes();
  for (const Vector3d& s :
       {Vector3d(0.05, 0.05, 0.1), Vector3d(0.0512, 0.0437, 0.1), Vector3d(0.03, 0.066, 0.1)}) {
    const std::vector<float> u = shape.at(s, p).displacement;
    ASSERT_EQ(u.size(), 3 * stored.size());
    std::size_t nearest = 0, farthest = 0;
    const auto distance = [&](std::size_t n) {
      return (dataset.mesh().nodes[at(stored[n])] - s).norm();
    };
    for (std::size_t n = 0; n < stored.size(); ++n) {
      if (distance(n) < distance(nearest)) nearest = n;
      if (distance(n) > distance(farthest)) farthest = n;
    }
    const auto moved = [&](std::size_t n) {
      return Eigen::Map<const Eigen::Vector3f>(&u[3 * n]).cast<double>().eval();
    };
    EXPECT_GT(moved(nearest).dot(p), 0.3 * p.squaredNorm());
    EXPECT_LT(moved(farthest).norm(), 0.5 * moved(nearest).norm());
  }
  const std::size_t site = nearestSite(dataset.spaces(), choice.spaces, {0, 0, 0.1});
  const Vector3d center = dataset.spaces()[site].patch.finger.value().center;
  for (const std::size_t other : choice.spaces)
    EXPECT_LE((center - Vector3d(0, 0, 0.1)).norm(),
              (dataset.spaces()[other].patch.finger->center - Vector3d(0, 0, 0.1)).norm());
}

}  // namespace
}  // namespace palpate
