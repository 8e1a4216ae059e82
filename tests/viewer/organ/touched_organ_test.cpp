#include "viewer/organ/touched_organ.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/dataset/dataset.hpp"
#include "common/problem/sites.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/touchable_body.hpp"
#include "viewer/share/organ_of_dataset.hpp"

namespace palpate {
namespace {

struct TouchedOrganTest : testing::Test {
  test::TemporaryDirectory directory;

  template <class Body>
  CarriedOrgan organOfBody(const Body& body) const {
    body.seal(directory / "body.h5");
    return organOf(Dataset(directory / "body.h5"));
  }
  static TouchedOrgan carried(const CarriedOrgan& organ) {
    return TouchedOrgan(decode(encode(organ)));
  }
  /// The middle of a touchable triangle.
  static SurfacePoint somewhere(const CarriedOrgan& organ, std::int32_t skip = 0) {
    for (std::int32_t t = 0; t < std::ssize(organ.triangles); ++t)
      if (organ.touch_of_triangle[at(t)] >= 0 && skip-- == 0) return {t, {0.25, 0.45, 0.3}};
    return {};
  }
};

TEST_F(TouchedOrganTest, AFingerFeelsTheForcesOfTheDataset) {
  const test::FingerBody body;
  const CarriedOrgan organ = organOfBody(body);
  std::vector<const SpaceTable*> sites;
  for (const SpaceTable& space : body.spaces) sites.push_back(&space);
  const AreaField whole(sites, placesAround(body.problem.mesh, centersOf(sites),
                                            body.spaces.front().patch.finger.value().radius));
  TouchedOrgan touched = carried(organ);
  for (std::int32_t n = 0; n < 6; ++n) {
    const SurfacePoint place = somewhere(organ, 3 * n);
    const Eigen::Vector3d s = touched.positionOf(place), p(0.002, 0.001 * n, -0.009);
    while (touched.prepare(0, s)) {
    }
    const AreaSample expected = whole.evaluate(s, p), got = touched.evaluate(0, s, p);
    EXPECT_GT(expected.force.norm(), 0.1);
    EXPECT_LT((got.force - expected.force).norm(), 1e-6);
    EXPECT_NEAR(got.error_bound, expected.error_bound, 1e-6);
    EXPECT_EQ(got.inside, expected.inside);
  }
}

TEST_F(TouchedOrganTest, AnActiveNodeKeepsEveryBit) {
  const Mesh mesh = test::cubeMesh(0.1, 2);
  const std::int32_t node = mesh.node_groups.at("zmax").front();
  const test::TouchableBody body(mesh, {{node, 1.0}});
  TouchedOrgan touched = carried(organOfBody(body));
  EXPECT_TRUE(touched.prepare(0, Eigen::Vector3d::Zero()));
  EXPECT_FALSE(touched.prepare(0, Eigen::Vector3d::Zero()));
  const Eigen::Vector3d p(0.004, -0.003, -0.011);
  const ForceSample expected = PotentialField(body.spaces.front()).evaluate(p);
  const AreaSample got = touched.evaluate(0, Eigen::Vector3d::Zero(), p);
  EXPECT_EQ(got.force, expected.force);
  EXPECT_EQ(got.stiffness, expected.stiffness);
  EXPECT_EQ(got.error_bound, expected.error_bound);
}

TEST_F(TouchedOrganTest, TheSurfaceMeetsTheToolAndFollowsTheSolvedShape) {
  const test::FingerBody body;
  const CarriedOrgan organ = organOfBody(body);
  TouchedOrgan touched = carried(organ);
  const SurfacePoint place = somewhere(organ);
  const Eigen::Vector3d p(0.001, 0.002, -0.008);
  while (touched.prepare(0, touched.positionOf(place))) {
  }
  std::vector<float> shape(3 * organ.vertices.size());
  touched.shapeAt(0, place, p, shape);
  Eigen::Vector3d at_anchor = Eigen::Vector3d::Zero();
  double farthest = 0, most = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto v = at(organ.triangles[at(place.triangle)][c]);
    at_anchor += place.barycentric[static_cast<Eigen::Index>(c)] *
                 Eigen::Map<const Eigen::Vector3f>(shape.data() + 3 * v).cast<double>();
  }
  EXPECT_LT((at_anchor - p).norm(), 1e-6);
  for (std::size_t v = 0; v < organ.vertices.size(); ++v) {
    const double away = (organ.vertices[v] - touched.positionOf(place)).norm();
    const double moved = Eigen::Map<const Eigen::Vector3f>(shape.data() + 3 * v).norm();
    most = std::max(most, moved);
    if (away > farthest) farthest = away;
    if (away < 0.09) continue;
    EXPECT_LT(moved, 0.5 * p.norm()) << "far away it moves less";
  }
  EXPECT_GT(farthest, 0.09);
  EXPECT_LT(most, 2 * p.norm());
}

}  // namespace
}  // namespace palpate
