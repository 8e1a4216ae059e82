#include "viewer/fields/area_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <mutex>
#include <random>

#include "tests/support/failed_point.hpp"
#include "tests/viewer/fields/area_sample.hpp"

namespace palpate {
namespace {

using test::PaperArea;

std::vector<const SpaceTable*> pointersTo(const std::vector<SpaceTable>& spaces) {
  std::vector<const SpaceTable*> pointers;
  for (const SpaceTable& space : spaces) pointers.push_back(&space);
  return pointers;
}

/// Places well inside the square and displacements well inside the ball.
class AreaFieldTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    spaces = new std::vector<SpaceTable>(PaperArea::sites());
    field = new AreaField(pointersTo(*spaces), PaperArea::plane(0.002));
  }
  static void TearDownTestSuite() {
    delete field;
    delete spaces;
  }
  Eigen::Vector3d drawPlace() { return {number(-0.03, 0.03), number(-0.03, 0.03), 0}; }
  Eigen::Vector3d drawDisplacement() {
    return {number(-0.012, 0.012), number(-0.012, 0.012), number(-0.012, 0.012)};
  }
  double number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  }

  /// Expects force and configurational force to be minus the slopes of the energy over 0.2 mm,
  /// because energies are sums in single precision.
  static void expectOneEnergy(const AreaField& area, const Eigen::Vector3d& s,
                              const Eigen::Vector3d& p, double force_tolerance,
                              double drive_tolerance, double stiffness_tolerance) {
    constexpr double h = 1e-4;
    const AreaSample here = area.evaluate(s, p);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(i);
      const AreaSample up = area.evaluate(s, p + e), down = area.evaluate(s, p - e),
                       on = area.evaluate(s + e, p), back = area.evaluate(s - e, p);
      EXPECT_NEAR((up.energy - down.energy) / (2 * h), -here.force[i], force_tolerance);
      EXPECT_NEAR((on.energy - back.energy) / (2 * h), -here.drive[i], drive_tolerance);
      EXPECT_LT(((up.force - down.force) / (2 * h) - here.stiffness.col(i)).norm(),
                stiffness_tolerance);
    }
  }

  static std::vector<SpaceTable>* spaces;
  static AreaField* field;
  std::mt19937 random{17};
};
std::vector<SpaceTable>* AreaFieldTest::spaces = nullptr;
AreaField* AreaFieldTest::field = nullptr;

// Regression: "100 %" was shown for seconds during interpolation to collocation points.
TEST_F(AreaFieldTest, ReportsItsProgressToTheEnd) {
  std::vector<double> shares;
  std::mutex adding;
  const AreaField area({&spaces->at(0), &spaces->at(1), &spaces->at(2)}, PaperArea::plane(0.002),
                       [&](double share) {
                         const std::scoped_lock lock(adding);
                         shares.push_back(share);
                       });
  std::ranges::sort(shares);
  EXPECT_EQ(shares.size(), area.siteCount() + area.collocationPointCount());
  EXPECT_GT(shares.front(), 0);
  EXPECT_EQ(shares.back(), 1);
  EXPECT_LT(shares[shares.size() - 2], 1);
}

TEST_F(AreaFieldTest, ForcesAreThoseOfTheEnergyBetweenSites) {
  double worst_force = 0, worst_drive = 0;
  for (int n = 0; n < 300; ++n) {
    const Eigen::Vector3d s = drawPlace(), p = drawDisplacement();
    const AreaSample sample = field->evaluate(s, p);
    EXPECT_TRUE(sample.inside);
    EXPECT_GT(sample.coverage, 0.9);
    worst_force = std::max(worst_force, (sample.force - PaperArea::force(s, p)).norm());
    worst_drive = std::max(worst_drive, (sample.drive - PaperArea::drive(s, p)).norm());
    EXPECT_NEAR(sample.energy, PaperArea::energy(s, p), 1e-4);
  }
  // Forces reach 4 N, configurational forces 0.5 N.
  EXPECT_LT(worst_force, 0.02);
  EXPECT_LT(worst_drive, 0.03);
}

/// The third derivatives at rest are a jump divided by a tiny step, as in a body whose fibres
/// become taut there.
TEST_F(AreaFieldTest, ContradictoryThirdDerivativesDoNoHarm) {
  std::vector<SpaceTable> jumping = *spaces;
  for (SpaceTable& site : jumping) {
    Equilibrium& rest = site.points.front().equilibrium;
    const SymmetricSlope jump = SymmetricSlope::Constant(rest.stiffness.norm() / 1e-6);
    rest.stiffness_by_p += jump;
    rest.stiffness_by_s += jump;
  }
  const AreaField area(pointersTo(jumping), PaperArea::plane(0.002));
  double worst = 0;
  for (int n = 0; n < 100; ++n) {
    const Eigen::Vector3d s = drawPlace(), p = drawDisplacement();
    worst = std::max(worst, (area.evaluate(s, p).force - PaperArea::force(s, p)).norm());
  }
  EXPECT_LT(worst, 0.04);
}

TEST_F(AreaFieldTest, ForcesAreMinusTheGradientsOfItsEnergy) {
  for (int n = 0; n < 50; ++n) {
    const Eigen::Vector3d s = drawPlace(), p = drawDisplacement();
    expectOneEnergy(*field, s, p, 1e-3, 1e-3, 0.5);
  }
}

/// Every second site has failed points on one side, so the edge changes from place to place.
TEST_F(AreaFieldTest, HasOneEnergyEvenBeyondTheComputedRegion) {
  std::vector<SpaceTable> uneven = *spaces;
  for (std::size_t n = 0; n < uneven.size(); n += 2)
    for (std::int32_t point = 0; point < uneven[n].lattice.size(); ++point)
      if (uneven[n].lattice.displacement(point).x() > 0.015)
        uneven[n].points[at(point)] = test::failedPoint();
  const AreaField area(pointersTo(uneven), PaperArea::plane(0.002));
  int beyond = 0;
  for (int n = 0; n < 200; ++n) {
    const Eigen::Vector3d s = drawPlace(), p = 3 * drawDisplacement();
    const AreaSample here = area.evaluate(s, p);
    if (here.beyond < 1e-3) continue;
    ++beyond;
    EXPECT_FALSE(here.inside);
    const double any = std::numeric_limits<double>::infinity(), force = here.force.norm();
    expectOneEnergy(area, s, p, 2e-3 + 1e-3 * force, 2e-3 + 2e-3 * force, any);
  }
  EXPECT_GT(beyond, 50);
}

TEST_F(AreaFieldTest, LoopsInPlaceAndDisplacementCreateNoEnergy) {
  for (int loop = 0; loop < 20; ++loop) {
    const Eigen::Vector3d s0 = drawPlace(), p0 = drawDisplacement(), s1 = drawPlace(),
                          p1 = drawDisplacement();
    // An ellipse through both spaces; the midpoint rule converges fast for periodic functions.
    constexpr int steps = 2000;
    double work = 0, exchanged = 0;
    for (int n = 0; n < steps; ++n) {
      const double a = 2 * M_PI * (n + 0.5) / steps, da = 2 * M_PI / steps;
      const AreaSample sample =
          field->evaluate(s0 * std::cos(a) + s1 * std::sin(a), p0 * std::cos(a) + p1 * std::sin(a));
      const double power = sample.force.dot(p1 * std::cos(a) - p0 * std::sin(a)) +
                           sample.drive.dot(s1 * std::cos(a) - s0 * std::sin(a));
      work += power * da;
      exchanged += std::abs(power) * da;
    }
    EXPECT_LT(std::abs(work), 1e-5 * exchanged);
  }
}

TEST_F(AreaFieldTest, NothingJumpsWhereCollocationPointsComeIntoReach) {
  Eigen::Vector3d s(-0.03, -0.021, 0);
  const Eigen::Vector3d p(0.006, -0.004, 0.008);
  AreaSample before = field->evaluate(s, p);
  for (int n = 0; n < 6000; ++n) {
    s += Eigen::Vector3d(1e-5, 0.7e-5, 0);
    const AreaSample here = field->evaluate(s, p);
    EXPECT_LT((here.force - before.force).norm(), 2e-3);
    EXPECT_LT((here.drive - before.drive).norm(), 2e-3);
    before = here;
  }
}

TEST_F(AreaFieldTest, BoundsItsErrorAtMostPlaces) {
  int held = 0;
  constexpr int tries = 300;
  for (int n = 0; n < tries; ++n) {
    const Eigen::Vector3d s = drawPlace(), p = drawDisplacement();
    const AreaSample sample = field->evaluate(s, p);
    held += (sample.force - PaperArea::force(s, p)).norm() <= sample.error_bound + 1e-5;
  }
  EXPECT_GE(held, 0.9 * tries);
}

TEST_F(AreaFieldTest, IsMoreAccurateWithCloserSites) {
  const std::vector<SpaceTable> close = PaperArea::sites(0.01);
  const AreaField finer(pointersTo(close), PaperArea::plane(0.002));
  double coarse_error = 0, fine_error = 0;
  for (int n = 0; n < 100; ++n) {
    const Eigen::Vector3d s = drawPlace(), p = drawDisplacement();
    coarse_error += (field->evaluate(s, p).force - PaperArea::force(s, p)).squaredNorm();
    fine_error += (finer.evaluate(s, p).force - PaperArea::force(s, p)).squaredNorm();
  }
  EXPECT_LT(fine_error, coarse_error);
}

TEST_F(AreaFieldTest, MarksPlacesWithoutAnAnswer) {
  const AreaSample away = field->evaluate({0.2, 0, 0}, {0.001, 0, 0});
  EXPECT_FALSE(away.inside);
  EXPECT_EQ(away.force, Eigen::Vector3d::Zero());
  EXPECT_FALSE(field->evaluate({0, 0, 0}, {0.04, 0, 0}).inside);
  EXPECT_EQ(field->evaluate({NAN, 0, 0}, {0, 0, 0}).force, Eigen::Vector3d::Zero());
  EXPECT_EQ(field->evaluate({0, 0, 0}, {NAN, 0, 0}).force, Eigen::Vector3d::Zero());
}

TEST_F(AreaFieldTest, OneSiteAnswersAroundItself) {
  const SpaceTable alone = PaperArea::space(Eigen::Vector3d::Zero());
  const AreaField single({&alone}, PaperArea::plane(0.002));
  const Eigen::Vector3d s(0.002, -0.001, 0), p(0.004, 0.003, -0.01);
  const AreaSample sample = single.evaluate(s, p);
  EXPECT_LT((sample.force - PaperArea::force(s, p)).norm(), 0.01);
  EXPECT_LT((sample.force - PaperArea::force(s, p)).norm(), sample.error_bound);
  EXPECT_LT(sample.error_bound, 0.05 * sample.force.norm());
  EXPECT_GT(single.evaluate(5 * s, p).error_bound, 2 * sample.error_bound) << "farther away";
}

/// A collocation point's lattice is finer where that of one of its sites is finer.
TEST_F(AreaFieldTest, HasOneEnergyOverRefinedAndUnrefinedSites) {
  std::vector<SpaceTable> mixed;
  for (const SpaceTable& site : *spaces)
    mixed.push_back(
        PaperArea::space(site.patch.finger->center, site.patch.finger->center.x() > 0.001));
  const AreaField area(pointersTo(mixed), PaperArea::plane(0.002));
  for (int n = 0; n < 100; ++n) {
    const Eigen::Vector3d s = drawPlace(), p = drawDisplacement();
    const AreaSample here = area.evaluate(s, p);
    EXPECT_LT((here.force - PaperArea::force(s, p)).norm(), 0.03);
    EXPECT_LT((here.drive - PaperArea::drive(s, p)).norm(), 0.03);
    expectOneEnergy(area, s, p, 1e-3, 1e-3, 1);
  }
}

/// Adds an energy A sin(k . p), which no polynomial matches, to that of a site.
SpaceTable withWave(SpaceTable space) {
  const Eigen::Vector3d k(120, -80, 100);  // 1/m
  constexpr double amplitude = 3e-3;       // J
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    Equilibrium& e = space.points[at(n)].equilibrium;
    const double phase = k.dot(space.lattice.displacement(n));
    const Eigen::Matrix3d kk = k * k.transpose();
    e.energy += amplitude * std::sin(phase);
    e.force -= amplitude * std::cos(phase) * k;
    e.stiffness += amplitude * std::sin(phase) * kk;
    for (std::size_t c = 0; c < symmetric_axes.size(); ++c)
      e.stiffness_by_p.row(static_cast<Eigen::Index>(c)) +=
          amplitude * std::cos(phase) * kk(symmetric_axes[c][0], symmetric_axes[c][1]) *
          k.transpose();
  }
  return space;
}

TEST_F(AreaFieldTest, HasSmallerBoundsAtRefinedSites) {
  std::vector<SpaceTable> whole, refined;
  for (const SpaceTable& site : *spaces) {
    whole.push_back(withWave(site));
    refined.push_back(withWave(PaperArea::space(site.patch.finger->center, true)));
  }
  const AreaField on_whole(pointersTo(whole), PaperArea::plane(0.002)),
      on_refined(pointersTo(refined), PaperArea::plane(0.002));
  double coarse = 0, fine = 0;
  for (int n = 0; n < 200; ++n) {
    const Eigen::Vector3d s = drawPlace(), p = 0.7 * drawDisplacement();
    coarse += on_whole.evaluate(s, p).error_bound;
    fine += on_refined.evaluate(s, p).error_bound;
  }
  EXPECT_LT(fine, 0.97 * coarse);
}

TEST_F(AreaFieldTest, AtRestTheForceIsKnownExactly) {
  for (int n = 0; n < 20; ++n) {
    const AreaSample sample = field->evaluate(drawPlace(), Eigen::Vector3d::Zero());
    EXPECT_LT(sample.force.norm(), 1e-6);
    EXPECT_LT(sample.error_bound, 1e-6);
  }
}

TEST_F(AreaFieldTest, BoundsOfSmallForcesAreSmall) {
  for (int n = 0; n < 100; ++n) {
    const Eigen::Vector3d s = drawPlace(), p = drawDisplacement();
    const AreaSample deep = field->evaluate(s, p), shallow = field->evaluate(s, 0.1 * p);
    EXPECT_LT(shallow.error_bound,
              1.5 * deep.error_bound * shallow.force.norm() / deep.force.norm());
  }
}

}  // namespace
}  // namespace palpate
