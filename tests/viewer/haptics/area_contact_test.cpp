// A hand on the area of a finger, with one energy E(s, p) everywhere.

#include <gtest/gtest.h>

#include <random>

#include "tests/support/failed_point.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/random_loops.hpp"
#include "tests/support/temporary_directory.hpp"
#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/deformed_shape.hpp"
#include "viewer/haptics/force_guard.hpp"

namespace palpate {
namespace {

class AreaContact : public ::testing::Test {
 protected:
  static const HapticModel& shared() {
    static const HapticModel model = [] {
      const test::TemporaryDirectory directory;
      test::FingerBody().seal(directory / "body.h5");
      return HapticModel(Dataset(directory / "body.h5"), {.methods = {"potential", "trilinear"}});
    }();
    return model;
  }
  std::int32_t topTriangle() const {
    for (std::int32_t t = 0; t < std::ssize(surface.triangles()); ++t)
      if (surface.faceNormal(t).z() > 0.9) return t;
    return -1;
  }
  /// The position of the anchor in the displayed shape of a touch.
  Eigen::Vector3d shownAtAnchor(const Touch& touch) const {
    std::vector<float> shape(3 * surface.vertices().size());
    DeformedShape(surface.vertices().size()).evaluate(model, touch, shape);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t c = 0; c < 3; ++c)
      sum += touch.anchor.barycentric[static_cast<Eigen::Index>(c)] *
             Eigen::Vector3f::Map(&shape[3 * at(surface.triangles()[at(touch.anchor.triangle)][c])])
                 .cast<double>();
    return sum;
  }
  const HapticModel& model = shared();
  const TouchSurface& surface = model.surface();
};

TEST_F(AreaContact, ExactlyTheAreaCanBeTouched) {
  ASSERT_EQ(surface.areas().size(), 1u);
  EXPECT_EQ(surface.areas()[0].name, "top");
  for (std::int32_t t = 0; t < std::ssize(surface.triangles()); ++t) {
    const bool on_top = surface.faceNormal(t).z() > 0.9;
    EXPECT_TRUE(surface.touchable(t) || !on_top);
    EXPECT_FALSE(surface.touchable(t) && surface.faceNormal(t).z() < -0.9);
    EXPECT_EQ(surface.areaOf(t) >= 0, surface.touchable(t));
  }
}

TEST_F(AreaContact, ForceIsThatOfTheEnergyAtTheAnchor) {
  const SurfacePoint anchor{topTriangle(), {0.2, 0.3, 0.5}};
  const Eigen::Vector3d s = surface.position(anchor), p(0.003, -0.001, -0.008);
  BlendedForce force;
  force.evaluate(model, 0, anchor, p);
  EXPECT_LT((force.force() - test::FingerBody::force(s, p)).norm(), 0.01);
  EXPECT_TRUE(force.sum().inside);
  EXPECT_GT(force.blend().size, 0);
}

TEST_F(AreaContact, ConfigurationalForceIsTheDescentOfTheEnergy) {
  const std::int32_t triangle = topTriangle();
  const SurfacePoint anchor{triangle, {0.2, 0.3, 0.5}};
  const Eigen::Vector3d tool = surface.position(anchor) + Eigen::Vector3d(0.003, -0.001, -0.008);
  BlendedForce force;
  const auto evaluateAt = [&](const Eigen::Vector3d& step) {
    SurfacePoint point = anchor;
    point.barycentric += surface.barycentricGradients(triangle).transpose() * step;
    force.evaluate(model, 0, point, tool - surface.position(point));
    return force.sum().energy;
  };
  constexpr double h = 1e-4;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(axis);
    const double slope = (evaluateAt(e) - evaluateAt(-e)) / (2 * h);
    evaluateAt({0, 0, 0});
    EXPECT_NEAR(force.slopeAlong(triangle).tangent[axis], slope, 2e-3);
  }
}

TEST_F(AreaContact, SpacesOfSitesAnswerAsTheAreaAtTheirPlaces) {
  const Eigen::Vector3d p(0.004, 0.002, -0.01);
  for (const std::size_t space : {0, 3}) {
    const Eigen::Vector3d s = model.spaces()[space].patch.finger->center;
    for (const std::size_t method : {0, 1}) {
      EXPECT_EQ(model.field(method, space).evaluate(p).force, model.area(0).evaluate(s, p).force);
      EXPECT_LT(
          (model.field(method, space).evaluate(p).force - test::FingerBody::force(s, p)).norm(),
          0.01);
    }
  }
}

/// The body in an area that ends inside its top, so that the rim has triangles on both sides.
class AreaRim : public ::testing::Test {
 protected:
  bool enters(const Eigen::Vector3d& place) const {
    Contact contact(model);
    contact.update(place + Eigen::Vector3d(0, 0, 0.01));
    return contact.update(place - Eigen::Vector3d(0, 0, 0.001)).touching;
  }
  bool flat(std::int32_t triangle) const { return surface.faceNormal(triangle).z() > 0.9; }
  const HapticModel model = [] {
    const test::TemporaryDirectory directory;
    const test::FingerBody body(0, "zmin", {.boxes = {{{0.02, 0.02, 0.09}, {0.06, 0.06, 0.11}}}});
    body.seal(directory / "body.h5");
    return HapticModel(Dataset(directory / "body.h5"), {.methods = {"potential"}});
  }();
  const TouchSurface& surface = model.surface();
};

TEST_F(AreaRim, IsEnteredAtItsEdgesAndVerticesButNotBeyond) {
  int edges = 0;
  for (std::int32_t t = 0; t < std::ssize(surface.triangles()); ++t)
    for (int c = 0; c < 3; ++c) {
      const std::int32_t other = surface.neighbor(t, c);
      if (!flat(t) || !flat(other) || !surface.touchable(t) || surface.touchable(other)) continue;
      ++edges;
      for (const double share : {0.0, 0.3, 0.5, 1.0}) {
        SurfacePoint point{t, Eigen::Vector3d::Zero()};
        point.barycentric[(c + 1) % 3] = share;
        point.barycentric[(c + 2) % 3] = 1 - share;
        EXPECT_TRUE(enters(surface.position(point))) << "triangle " << t << " at " << share;
      }
      EXPECT_FALSE(enters(surface.position({other, Eigen::Vector3d::Constant(1.0 / 3)})));
    }
  EXPECT_GT(edges, 3);
}

/// A path 5 mm deep across the top, over many triangles and sites.
Eigen::Vector3d acrossTheTop(double t) {
  return {0.015 + 0.07 * t, 0.03 + 0.03 * std::sin(5 * t), 0.1 - 0.005 * std::sin(M_PI * t)};
}

TEST_F(AreaContact, SlidingCreatesNoEnergy) {
  for (const double friction : {0.0, 0.3}) {
    Contact contact(model, {.friction = friction});
    contact.update({0.015, 0.03, 0.11});
    double work = 0;
    constexpr int steps = 20000;
    Eigen::Vector3d last_tool = acrossTheTop(0), last_force = Eigen::Vector3d::Zero();
    double last_energy = 0, most = 0;
    for (int n = 0; n <= steps; ++n) {
      const Eigen::Vector3d tool = acrossTheTop(static_cast<double>(n) / steps);
      const Touch& touch = contact.update(tool);
      work -= 0.5 * (touch.force + last_force).dot(tool - last_tool);  // work of the hand
      most = std::max(most, touch.energy);
      // The stored energy never exceeds the hand's work, up to the error of the sum.
      ASSERT_LT(touch.energy, work + 2e-3 * most + 1e-9) << "step " << n;
      last_energy = touch.energy;
      last_tool = tool;
      last_force = touch.force;
    }
    EXPECT_GT(most, 1e-4);
    EXPECT_LT(last_energy, most);
  }
}

TEST_F(AreaContact, NoForceJumpsWhileSlidingOverTrianglesAndSites) {
  Contact contact(model, {.friction = 0.2});
  contact.update({0.015, 0.03, 0.11});
  constexpr int steps = 20000;
  Touch last;
  double worst = 0;
  for (int n = 0; n <= steps; ++n) {
    const double t = static_cast<double>(n) / steps;
    const Touch touch = contact.update(acrossTheTop(t));
    if (last.touching && touch.touching && last.force.norm() > 0.1) {
      const double motion = (acrossTheTop(t) - acrossTheTop(t - 1.0 / steps)).norm();
      const double step = (touch.force - last.force).norm() - touch.stiffness.norm() * motion;
      worst = std::max(worst, step / touch.force.norm());
    }
    last = touch;
  }
  EXPECT_LT(worst, 0.01);
}

/// Straight in, by more than the depth of the body, at places all over the top.
TEST_F(AreaContact, NothingPassesThroughBelowTheLargestForce) {
  for (double x = 0.02; x < 0.09; x += 0.01) {
    Contact contact(model);
    double edge = 0, reached = 0;
    for (double depth = -0.002; depth < 0.12 && reached == 0; depth += 0.0005) {
      const Touch& touch = contact.update({x, 0.05, 0.1 - depth});
      EXPECT_EQ(touch.touching, depth > 0 || touch.touching) << depth;
      if (touch.inside) edge = depth;
      if (touch.force.norm() >= model.maxForce()) reached = depth;
    }
    EXPECT_GT(reached, 0) << "at x = " << x;
    EXPECT_LT(reached, edge + 0.004) << "at x = " << x;
  }
}

/// Deep points failed on one side of the body; on another side there is a fold, beyond which all
/// forces are larger.
test::FingerBody withAHoleAndAFold() {
  test::FingerBody body;
  for (SpaceTable& space : body.spaces)
    for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
      const Eigen::Vector3d p = space.lattice.displacement(n), &s = space.patch.finger->center;
      PointRecord& point = space.points[static_cast<std::size_t>(n)];
      if (s.x() < 0.05 && p.z() < -0.008) point = test::failedPoint();
      if (s.y() > 0.05 && p.x() > 0.004) point.equilibrium.force.z() += 0.8;
    }
  return body;
}

/// A hand guided in and out, to and fro, over the whole area.
TEST_F(AreaContact, TheGuardBoundsForceAndEnergyAtAHoleAndAFold) {
  const test::TemporaryDirectory directory;
  withAHoleAndAFold().seal(directory / "body.h5");
  const HapticModel holed(Dataset(directory / "body.h5"), {.methods = {"potential"}});
  const GuardOptions options;
  const double slew = slewOf(options) * options.period;
  std::mt19937 random(11);
  int beyond = 0, covered_less = 0;
  for (int path = 0; path < 20; ++path) {
    const test::RandomLoop loop(random, 0.045);
    Contact contact(holed);
    ForceGuard guard(options);
    const auto placeAt = [&](int tick) -> Eigen::Vector3d {
      const double t = tick / 4000.0;
      // The tool comes from above and goes back up.
      return Eigen::Vector3d(0.05, 0.05, 0.1 + 0.05 * std::abs(1 - 2 * t)) + loop.at(t);
    };
    Eigen::Vector3d before = Eigen::Vector3d::Zero();
    double given = 0;  // J, given to the hand
    for (int tick = 0; tick <= 4000; ++tick) {
      GuardInput input;
      input.tool = placeAt(tick);
      input.touch = contact.update(input.tool);
      const GuardedForce guarded = guard.limit(input);
      ASSERT_TRUE(guarded.force.allFinite());
      EXPECT_LE(guarded.force.norm(), options.max_force * (1 + 1e-12));
      EXPECT_LE((guarded.force - before).norm(), slew * (1 + 1e-9));
      if (input.touch.touching && !input.touch.inside) {
        ++beyond;
        EXPECT_NE(guarded.guards & static_cast<std::uint32_t>(Guarded::beyond), 0u);
      }
      if (input.touch.inside && input.touch.coverage < 0.9) ++covered_less;
      given += guarded.force.dot(placeAt(tick + 1) - input.tool);
      before = guarded.force;
    }
    EXPECT_LT(given, 1e-3) << "path " << path;
  }
  EXPECT_GT(beyond, 100);
  EXPECT_GT(covered_less, 100);
}

TEST_F(AreaContact, TheShapeMeetsTheToolUntilTheAnswersEnd) {
  Contact contact(model, {.friction = 10});
  const auto at_depth = [&](double depth) -> const Touch& {
    for (int n = 0; n <= 100; ++n) contact.update({0.052, 0.047, 0.101 - depth * n / 100});
    return contact.touch();
  };
  const Touch& shallow = at_depth(0.01);
  ASSERT_TRUE(shallow.touching && shallow.inside);
  EXPECT_LT((shownAtAnchor(shallow) - shallow.displacement).norm(), 1e-6);
  const Touch& deep = at_depth(0.05);
  ASSERT_TRUE(deep.touching && !deep.inside);
  EXPECT_GT(deep.beyond, 0.01);
  EXPECT_NEAR((deep.displacement - deep.excess()).norm(), deep.displacement.norm() - deep.beyond,
              1e-12);
  EXPECT_LT((shownAtAnchor(deep) - (deep.displacement - deep.excess())).norm(), 1e-5);
}

}  // namespace
}  // namespace palpate
