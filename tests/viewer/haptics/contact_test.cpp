#include "viewer/haptics/contact.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/viewer/haptics/touched_model.hpp"

namespace palpate {
namespace {

using Path = std::function<Eigen::Vector3d(double)>;  ///< from 0..1

/// The models are created once because sealing takes a while.
const HapticModel& flatModel() {
  static const HapticModel model = test::cubeModel();
  return model;
}
const HapticModel& gradedModel() {
  static const HapticModel model =
      test::cubeModel([](const Eigen::Vector3d& x) { return 1 + 5 * x.x(); });
  return model;
}
const HapticModel& tenNodes() {
  static const HapticModel model = test::tenNodeModel();
  return model;
}
const HapticModel& wholeBlob() {
  static const HapticModel model = [] {
    const Mesh mesh = test::blobMesh(4);
    return test::modelOf({mesh, test::wholeSurface(mesh, [](const Eigen::Vector3d& x) {
                            return 1 + 0.2 * std::sin(40 * x.x()) + 0.15 * std::cos(50 * x.y());
                          })});
  }();
  return model;
}

/// Straight down into the cube and back up.
Eigen::Vector3d pressing(double t, double depth) {
  return {0.052, 0.047, 0.105 - (0.005 + depth) * (1 - std::abs(2 * t - 1))};
}

/// Work of the tissue on the tool along a path, by the trapezoidal rule, J.
struct Work {
  double net = 0, exchanged = 0;
};
Work workAlong(const HapticModel& model, const ContactOptions& options, const Path& path, int ticks,
               std::size_t method = 0) {
  Contact contact(model, options);
  contact.use(model, method);
  Work work;
  Eigen::Vector3d last_tool = path(0), last_force = Eigen::Vector3d::Zero();
  for (int n = 0; n <= ticks; ++n) {
    const Eigen::Vector3d tool = path(static_cast<double>(n) / ticks);
    const Eigen::Vector3d force = contact.update(tool).force;
    const double step = 0.5 * (force + last_force).dot(tool - last_tool);
    work.net += step;
    work.exchanged += std::abs(step);
    last_tool = tool;
    last_force = force;
  }
  EXPECT_FALSE(contact.touch().touching);
  return work;
}

/// In from above, along a loop under the surface, and out elsewhere.
Eigen::Vector3d kneading(double t) {
  const double depth = 0.014 * std::sin(M_PI * t), angle = 2 * M_PI * t;
  return {0.05 + 0.018 * std::cos(angle) + 0.004 * t, 0.05 + 0.015 * std::sin(angle),
          0.1005 - depth};
}

/// A smooth walk around a body and through it.
class Walk {
 public:
  Walk(const HapticModel& model, unsigned seed) : random_(seed) {
    for (const Eigen::Vector3d& v : model.surface().vertices()) box_.extend(v);
    for (Wave& wave : waves_) {
      wave.amplitude = 0.4 * box_.sizes();
      for (Eigen::Index a = 0; a < 3; ++a) {
        wave.rate[a] = 1 + 4 * uniform();
        wave.phase[a] = 2 * M_PI * uniform();
      }
    }
  }
  Eigen::Vector3d at(double t) const {
    Eigen::Vector3d x = box_.center();
    for (const Wave& wave : waves_)
      x += wave.amplitude.cwiseProduct((wave.rate * t + wave.phase).array().sin().matrix());
    return x;
  }

 private:
  struct Wave {
    Eigen::Vector3d amplitude, rate, phase;
  };
  double uniform() { return static_cast<double>(random_()) / 4294967296.0; }
  std::mt19937 random_;
  Eigen::AlignedBox3d box_;
  std::array<Wave, 2> waves_;
};

TEST(Contact, BeginsAndEndsWithoutAJumpOfForce) {
  Contact contact(flatModel());
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  bool touched = false;
  for (int n = 0; n <= 400; ++n) {
    const Touch& touch = contact.update(pressing(n / 400.0, 0.015));
    EXPECT_LT((touch.force - last).norm(), 200 * 0.0001);  // stiffness at 15 mm times the motion
    EXPECT_FALSE(touch.stepped);
    touched = touched || touch.touching;
    last = touch.force;
  }
  EXPECT_TRUE(touched);
  EXPECT_FALSE(contact.touch().touching);
  EXPECT_NEAR(contact.touch().gap, 0.005, 1e-12);
}

TEST(Contact, PushesAsTheForceFieldSays) {
  Contact contact(flatModel(), {.friction = 10});
  for (int n = 0; n <= 100; ++n) contact.update(pressing(n / 200.0, 0.015));
  const Touch& touch = contact.touch();
  ASSERT_TRUE(touch.touching);
  EXPECT_LT((touch.displacement - Eigen::Vector3d(0, 0, -0.015)).norm(), 1e-9);
  const ForceSample sample = flatModel().field(0, 0).evaluate(touch.displacement);
  EXPECT_LT((touch.force - sample.force).norm(), 1e-12);
  EXPECT_LT((touch.stiffness - sample.stiffness).norm(), 1e-9);
  EXPECT_NEAR(touch.energy, sample.energy, 1e-15);
  EXPECT_TRUE(touch.inside);
  EXPECT_LT((touch.normal - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_LT((touch.anchor_position - Eigen::Vector3d(0.052, 0.047, 0.1)).norm(), 1e-9);
}

TEST(Contact, NeverPullsOnRandomWalks) {
  int touched = 0, contacts = 0;
  for (const HapticModel* model : {&flatModel(), &tenNodes(), &wholeBlob()})
    for (const double friction : {0.0, 0.2, 1.0}) {
      Contact contact(*model, {.friction = friction});
      const Walk walk(*model, 20);
      bool last = false;
      for (int n = 0; n < 20000; ++n) {
        const Touch& touch = contact.update(walk.at(0.0005 * n));
        ASSERT_TRUE(touch.force.allFinite());
        ASSERT_EQ(touch.blend.size > 0, touch.touching);
        ASSERT_EQ(touch.force.isZero(0), !touch.touching);
        if (touch.touching) {
          ASSERT_TRUE(touch.force.dot(touch.normal) > 0 ||
                      touch.displacement.dot(touch.normal) < 0);
          ASSERT_GE(touch.anchor.barycentric.minCoeff(), 0);
          ASSERT_NEAR(touch.anchor.barycentric.sum(), 1, 1e-14);
          ASSERT_TRUE(model->surface().touchable(touch.anchor.triangle));
          ++touched;
        }
        contacts += touch.touching && !last ? 1 : 0;
        last = touch.touching;
      }
    }
  EXPECT_GT(touched, 5000);
  EXPECT_GT(contacts, 50);
}

/// A cube that yields sideways like a thin lobe: its force leans from the normal.
const HapticModel& leaningCube() {
  static const HapticModel model = [] {
    const Mesh mesh = test::cubeMesh(0.1, 4);
    std::vector<test::TouchableBody::Active> active = test::wholeSurface(mesh);
    for (auto& one : active) one.stiff_along = {20, 8, 15};
    return test::modelOf({mesh, active});
  }();
  return model;
}

TEST(Contact, LetsNoInwardPressPassThrough) {
  const HapticModel& model = leaningCube();
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> along(0.02, 0.08);
  int pressed = 0;
  for (int n = 0; n < 200; ++n) {
    Eigen::Vector3d direction(normal(random), normal(random), normal(random));
    direction.normalize();
    if (direction.z() > -0.35) continue;
    const Eigen::Vector3d start(along(random), along(random), 0.1);
    Contact contact(model);
    bool touched = false;
    double deepest = 0;
    for (double s = -0.002; s < 0.06; s += 0.0002) {
      const Touch& touch = contact.update(start + s * direction);
      touched |= touch.touching;
      if (!touch.touching && touched) deepest = std::max(deepest, -touch.gap);
    }
    EXPECT_TRUE(touched);
    EXPECT_LT(deepest, 0.001) << "passed through from " << start.transpose() << " along "
                              << direction.transpose();
    ++pressed;
  }
  EXPECT_GT(pressed, 50);
}

TEST(Contact, MissesNoEntryOnRandomWalks) {
  int entries = 0;
  for (const unsigned seed : {1, 2, 3, 4, 5}) {
    Contact contact(flatModel(), {.friction = 0});
    const Walk walk(flatModel(), seed);
    bool was_outside = false;
    for (int n = 0; n < 100000; ++n) {
      const Eigen::Vector3d tool = walk.at(0.0001 * n);
      const Touch& touch = contact.update(tool);
      const bool is_outside = !touch.touching && touch.gap >= 0;
      if (was_outside && !is_outside) {
        ++entries;
        EXPECT_TRUE(touch.touching) << n << ": " << tool.transpose();
      }
      was_outside = is_outside;
    }
  }
  EXPECT_GT(entries, 20);
}

TEST(Contact, TouchesAgainAfterARelease) {
  Contact contact(flatModel());
  for (int round = 0; round < 3; ++round) {
    contact.update(pressing(0, 0.01));
    EXPECT_FALSE(contact.touch().touching);
    for (int n = 0; n <= 50; ++n) contact.update(pressing(n / 100.0, 0.01));
    EXPECT_TRUE(contact.touch().touching) << round;
    for (int n = 50; n <= 100; ++n) contact.update(pressing(n / 100.0, 0.01));
    EXPECT_FALSE(contact.touch().touching) << round;
  }
}

TEST(Contact, TouchesOnTheSlowestEntry) {
  Contact contact(flatModel());
  for (int n = 0; n < 2000; ++n) contact.update({0.05, 0.05, 0.1 + 1e-8 * (500 - n)});
  EXPECT_TRUE(contact.touch().touching);
}

TEST(Contact, TouchesAtAnEdgeAndAtAVertex) {
  for (const Eigen::Vector3d& x :
       {Eigen::Vector3d(0.05, 0.05, 0.1), Eigen::Vector3d(0.0375, 0.05, 0.1),
        Eigen::Vector3d(0.05, 0.0375, 0.1), Eigen::Vector3d(0.0375, 0.0375, 0.1)})
    for (const double step : {1e-3, 1e-4}) {
      Contact contact(flatModel());
      for (int n = 0; n * step < 0.007; ++n)
        contact.update(x + Eigen::Vector3d(0, 0, 0.002 - n * step));
      EXPECT_TRUE(contact.touch().touching) << x.transpose();
      EXPECT_FALSE(contact.touch().stepped);
    }
}

TEST(Contact, FeelsNothingInsideUntilItHasBeenOutside) {
  Contact contact(flatModel());
  contact.update({0.05, 0.05, 0.08});
  EXPECT_FALSE(contact.touch().touching);
  EXPECT_NEAR(contact.touch().gap, -0.02, 1e-12);
  contact.update({0.05, 0.05, 0.07});
  EXPECT_FALSE(contact.touch().touching);
  contact.update({0.05, 0.05, 0.101});
  contact.update({0.05, 0.05, 0.0999});
  EXPECT_TRUE(contact.touch().touching);
}

TEST(Contact, FeelsNothingAfterEnteringAnUntouchablePart) {
  const Mesh mesh = test::cubeMesh(0.1, 4);
  const HapticModel model = test::modelOf({mesh, {{112}}});  // the middle of the top
  Contact contact(model);
  contact.update({0.005, 0.03, 0.105});
  contact.update({0.005, 0.03, 0.095});
  contact.update({0.05, 0.05, 0.095});
  EXPECT_FALSE(contact.touch().touching);
  contact.update({0.05, 0.05, 0.101});
  contact.update({0.05, 0.05, 0.0995});
  EXPECT_TRUE(contact.touch().touching);
}

TEST(Contact, EndsWhenThePositionIsNotFinite) {
  Contact contact(flatModel());
  for (int n = 0; n <= 50; ++n) contact.update(pressing(n / 100.0, 0.01));
  ASSERT_TRUE(contact.touch().touching);
  const Touch& touch = contact.update({std::nan(""), 0, 0});
  EXPECT_FALSE(touch.touching);
  EXPECT_TRUE(touch.stepped);
  EXPECT_EQ(touch.force, Eigen::Vector3d::Zero());
  EXPECT_FALSE(contact.update({0.05, 0.05, 0.09}).touching);
  EXPECT_FALSE(contact.touch().stepped);
  contact.update({0.05, 0.05, 0.101});
  EXPECT_TRUE(contact.update({0.05, 0.05, 0.0999}).touching);
}

TEST(Contact, ReleasesOnDemandAndReportsTheStep) {
  Contact contact(flatModel());
  for (int n = 0; n <= 50; ++n) contact.update(pressing(n / 100.0, 0.01));
  contact.release();
  EXPECT_FALSE(contact.touch().touching);
  const Touch& touch = contact.update(pressing(0.5, 0.01));
  EXPECT_FALSE(touch.touching);
  EXPECT_TRUE(touch.stepped);
  contact.update(pressing(0.5, 0.01));
  EXPECT_FALSE(contact.touch().stepped);
}

TEST(Contact, GluedContactPullsToo) {
  Contact contact(flatModel(), {.mode = ContactMode::glued, .grab_distance = 0.005});
  const Eigen::Vector3d start(0.05, 0.05, 0.103);
  EXPECT_FALSE(contact.update({0.05, 0.05, 0.106}).touching);
  EXPECT_TRUE(contact.update(start).touching);
  EXPECT_LT(contact.touch().force.norm(), 1e-12);
  for (int n = 1; n <= 100; ++n) contact.update(start + Eigen::Vector3d(0, 0, 1e-4 * n));
  EXPECT_LT(contact.touch().force.z(), -0.5);
  EXPECT_LT((contact.touch().displacement - Eigen::Vector3d(0, 0, 0.01)).norm(), 1e-15);
  EXPECT_LT((contact.touch().anchor_position - Eigen::Vector3d(0.05, 0.05, 0.1)).norm(), 1e-12);

  contact.update(start + Eigen::Vector3d(0, 0, 0.01), false);
  EXPECT_FALSE(contact.touch().touching);
  EXPECT_TRUE(contact.touch().stepped);
  contact.update(start, true);
  EXPECT_TRUE(contact.touch().touching);
  EXPECT_LT(contact.touch().force.norm(), 1e-12);
}

TEST(Contact, GluedContactGripsAgainOnlyAfterHoldEnds) {
  Contact contact(flatModel(), {.mode = ContactMode::glued});
  const Eigen::Vector3d tool(0.05, 0.05, 0.101);
  EXPECT_TRUE(contact.update(tool).touching);
  contact.release();
  EXPECT_FALSE(contact.update(tool).touching);
  EXPECT_FALSE(contact.update(tool, false).touching);
  EXPECT_TRUE(contact.update(tool).touching);
  contact.release();
  EXPECT_FALSE(contact.update(tool).touching);
  EXPECT_FALSE(contact.update({0.05, 0.05, 0.12}).touching);
  EXPECT_TRUE(contact.update(tool).touching);
}

TEST(Contact, SticksWithinTheFrictionConeAndSlidesAtItsRim) {
  Contact contact(flatModel(), {.friction = 0.3});
  for (int n = 0; n <= 100; ++n) contact.update(pressing(n / 200.0, 0.012));
  for (int n = 0; n < 50; ++n) contact.update(pressing(0.5, 0.012));
  const Eigen::Vector3d start = contact.touch().anchor_position;
  contact.update(pressing(0.5, 0.012) + Eigen::Vector3d(1e-4, 0, 0));
  EXPECT_EQ(contact.touch().anchor_position, start);
  double largest = 0;
  for (int n = 1; n <= 200; ++n) {
    const Touch& touch = contact.update(pressing(0.5, 0.012) + Eigen::Vector3d(1e-4 * n, 0, 0));
    ASSERT_TRUE(touch.touching);
    const double cone = touch.force.head<2>().norm() / touch.force.z();
    EXPECT_LT(cone, 0.3 * 1.001);
    largest = std::max(largest, cone);
  }
  EXPECT_NEAR(largest, 0.3, 1e-3);
  EXPECT_GT((contact.touch().anchor_position - start).norm(), 0.01);
}

TEST(Contact, StopsAtTheRimOfTheTouchableSurface) {
  const Mesh mesh = test::cubeMesh(0.1, 4);
  const HapticModel model = test::modelOf({mesh, {{112}}});
  Contact contact(model, {.friction = 0});
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (int n = 0; n <= 100; ++n) last = contact.update({0.05, 0.05, 0.1 - 1e-4 * n}).force;
  for (int n = 0; n <= 500; ++n) {
    const Touch& touch = contact.update({0.05 + 1e-4 * n, 0.05 + 0.3e-4 * n, 0.09});
    if (!touch.inside || !touch.touching) break;
    ASSERT_TRUE(model.surface().touchable(touch.anchor.triangle));
    EXPECT_LT((touch.force - last).norm(), 1.05e-4 * touch.stiffness.norm());
    last = touch.force;
  }
  EXPECT_GT(last.norm(), 0);
}

struct Sweep {
  double largest_share = 0;   ///< step of the force between ticks, relative to the force
  double largest_excess = 0;  ///< the same, minus the share explained by motion and stiffness
  int ticks = 0, triangles = 0;
};

/// Moves the tool across the body at 0.1 m/s and 1 kHz, 10 to 20 mm deep.
Sweep sweepOver(const HapticModel& model, double friction, double top) {
  Sweep sweep;
  for (const double y : {-0.021, -0.01, 0.0, 0.0105, 0.022})
    for (const double side : {-1.0, 1.0}) {
      Contact contact(model, {.friction = friction});
      Eigen::Vector3d last_tool, last_force = Eigen::Vector3d::Zero();
      double last_stiffness = 0;
      std::int32_t last_triangle = -1;
      for (int n = 0; n < 900; ++n) {
        const double down = std::min(0.03, 1e-4 * n), along = 1e-4 * std::max(0, n - 300);
        const Eigen::Vector3d tool(side * (-0.03 + along), y + 0.003 * std::sin(100 * along),
                                   top + 0.012 - down + 0.003 * std::cos(60 * along));
        const Touch& touch = contact.update(tool);
        if (n > 350 && touch.touching && last_force.norm() > 0.2) {
          const double step = (touch.force - last_force).norm(), force = last_force.norm();
          sweep.largest_share = std::max(sweep.largest_share, step / force);
          sweep.largest_excess =
              std::max(sweep.largest_excess,
                       (step - 3 * last_stiffness * (tool - last_tool).norm()) / force);
          sweep.triangles += touch.anchor.triangle != last_triangle ? 1 : 0;
          ++sweep.ticks;
        }
        last_tool = tool;
        last_force = touch.force;
        last_stiffness = touch.stiffness.norm();
        last_triangle = touch.anchor.triangle;
      }
    }
  return sweep;
}

TEST(Contact, SlidesOverEdgesAndVerticesWithoutAJumpOfForce) {
  for (const auto& [model, top] : {std::pair(&tenNodes(), 0.05), std::pair(&wholeBlob(), 0.05)})
    for (const double friction : {0.0, 0.2}) {
      const Sweep sweep = sweepOver(*model, friction, top);
      std::printf(
          "%zu spaces, friction %.1f: largest step %.2f %% of the force, %.3f %% beyond motion; "
          "%d ticks, %d triangles\n",
          model->spaces().size(), friction, 100 * sweep.largest_share, 100 * sweep.largest_excess,
          sweep.ticks, sweep.triangles);
      EXPECT_LT(sweep.largest_excess, 0.01);
      EXPECT_GT(sweep.ticks, 2000);
      EXPECT_GT(sweep.triangles, 15);
    }
}

TEST(Contact, ReturnsAllWorkWithoutFriction) {
  for (const HapticModel* model : {&flatModel(), &gradedModel()}) {
    double last = 1;
    for (const int ticks : {1000, 2000, 4000, 8000}) {
      const Work work = workAlong(*model, {.friction = 0}, kneading, ticks);
      const double share = std::abs(work.net) / work.exchanged;
      std::printf("%d ticks: net %.3e J of %.3e J, %.3e\n", ticks, work.net, work.exchanged, share);
      EXPECT_LT(share, 0.7 * last);
      last = share;
    }
    EXPECT_LT(last, 1e-3);
  }
}

TEST(Contact, WouldCreateEnergyWithoutTheEnergiesOfTheSpaces) {
  // Tri-linear forces have no energy, so the anchor slides by the force alone.
  const Work work = workAlong(gradedModel(), {.friction = 0}, kneading, 8000, 1);
  EXPECT_GT(std::abs(work.net) / work.exchanged, 1e-3);
}

TEST(Contact, TakesWorkFromTheHandWithFriction) {
  for (const HapticModel* model : {&flatModel(), &gradedModel()})
    for (const double friction : {0.1, 0.5}) {
      const Work work = workAlong(*model, {.friction = friction}, kneading, 4000);
      EXPECT_LT(work.net, -0.02 * work.exchanged);
    }
}

TEST(Contact, NeverReturnsMoreWorkThanItTookOnRandomWalks) {
  for (const HapticModel* model : {&tenNodes(), &wholeBlob()})
    for (const double friction : {0.0, 0.2}) {
      Contact contact(*model, {.friction = friction});
      double given = 0, taken = 0;
      Eigen::Vector3d last_force = Eigen::Vector3d::Zero(), last_tool = Eigen::Vector3d::Zero();
      const Walk walk(*model, 3);
      for (int n = 0; n < 100000; ++n) {
        const Eigen::Vector3d wave = walk.at(0.0001 * n);
        // Stay within the workspaces, because a force beyond them has no potential.
        const Eigen::Vector3d tool(0.5 * wave.x(), 0.5 * wave.y(), 0.05 + 0.2 * wave.z());
        const Touch& touch = contact.update(tool);
        ASSERT_TRUE(touch.inside);
        const double work = n > 0 ? 0.5 * (touch.force + last_force).dot(tool - last_tool) : 0;
        (work > 0 ? given : taken) += std::abs(work);
        ASSERT_LE(given, 1.001 * taken + 1e-6);
        last_force = touch.force;
        last_tool = tool;
      }
      EXPECT_GT(given, 1e-3);
    }
}

TEST(Contact, ContinuesWithAnotherModelOfTheSameSurface) {
  Contact contact(flatModel());
  for (int n = 0; n <= 100; ++n) contact.update(pressing(n / 200.0, 0.01));
  const Touch before = contact.touch();
  contact.use(gradedModel(), 0);
  const Touch& after = contact.update(pressing(0.5, 0.01));
  EXPECT_TRUE(after.touching);
  EXPECT_TRUE(after.stepped);
  EXPECT_GT(after.force.z(), 1.1 * before.force.z());
  EXPECT_FALSE(contact.update(pressing(0.5, 0.01)).stepped);
  contact.use(gradedModel(), 1);
  EXPECT_TRUE(contact.update(pressing(0.5, 0.01)).stepped);
  EXPECT_TRUE(std::isnan(contact.touch().energy));
}

TEST(Contact, EndsWithAModelOfAnotherSurface) {
  Contact contact(flatModel());
  for (int n = 0; n <= 100; ++n) contact.update(pressing(n / 200.0, 0.01));
  contact.use(tenNodes(), 0);
  EXPECT_FALSE(contact.touch().touching);
  EXPECT_TRUE(contact.update(pressing(0.5, 0.01)).stepped);
}

}  // namespace
}  // namespace palpate
