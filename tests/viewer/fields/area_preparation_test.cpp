#include <gtest/gtest.h>

#include "common/problem/sites.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"
#include "viewer/fields/area_field.hpp"

namespace palpate {
namespace {

struct AreaPreparation : testing::Test {
  test::FingerBody body;
  std::vector<const SpaceTable*> sites;
  std::vector<Eigen::Vector3d> surface;
  const Eigen::Vector3d s{0.052, 0.047, 0.1}, p{0.003, -0.002, -0.008};

  AreaPreparation() {
    for (const SpaceTable& space : body.spaces) sites.push_back(&space);
    surface = placesAround(body.problem.mesh, centersOf(sites),
                           body.spaces.front().patch.finger.value().radius);
  }
  AreaField area() const { return {sites, AreaField::collocationPointsOf(sites, surface)}; }
};

TEST_F(AreaPreparation, AnswersAsTheWholeFieldToTheLastBit) {
  const AreaField whole(sites, surface);
  AreaField growing = area();
  for (const Eigen::Vector3d& step : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.02, 0.01, 0),
                                      Eigen::Vector3d(-0.03, 0.02, 0)}) {
    while (growing.prepareNext(s + step)) {
    }
    const AreaSample expected = whole.evaluate(s + step, p), got = growing.evaluate(s + step, p);
    EXPECT_GT(expected.force.norm(), 0.1);
    EXPECT_EQ(got.force, expected.force);
    EXPECT_EQ(got.drive, expected.drive);
    EXPECT_EQ(got.energy, expected.energy);
    EXPECT_EQ(got.error_bound, expected.error_bound);
    EXPECT_EQ(got.coverage, expected.coverage);
  }
}

TEST_F(AreaPreparation, AtOnceAndStepByStepGiveTheSameField) {
  AreaField piecewise = area(), at_once = area();
  for (const Eigen::Vector3d& step : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.03, 0.01, 0)}) {
    while (piecewise.prepareNext(s + step)) {
    }
    at_once.prepareAt(s + step);
    EXPECT_FALSE(at_once.prepareNext(s + step));
    EXPECT_EQ(at_once.madeSites(), piecewise.madeSites());
    EXPECT_EQ(at_once.evaluate(s + step, p).force, piecewise.evaluate(s + step, p).force);
  }
}

TEST_F(AreaPreparation, PreparesNoMoreThanIsNeeded) {
  AreaField growing = area();
  EXPECT_FALSE(growing.evaluate(s, p).inside) << "nothing is prepared";
  while (growing.prepareNext(s)) {
  }
  EXPECT_TRUE(growing.evaluate(s, p).inside);
  EXPECT_LT(growing.madeSites(), growing.siteCount());
  while (growing.prepareSite(s)) {
  }
  EXPECT_EQ(growing.madeSites(), growing.siteCount());
}

// Regression: the preparation read the spacing of a lattice that did not exist yet.
TEST_F(AreaPreparation, FarFromAllCollocationPointsThereIsNoAnswer) {
  AreaField growing = area();
  const Eigen::Vector3d nowhere(1, 1, 1);
  EXPECT_FALSE(growing.prepareNext(nowhere));
  EXPECT_FALSE(growing.evaluate(nowhere, p).inside);
  EXPECT_EQ(growing.evaluate(nowhere, p).force, Eigen::Vector3d::Zero());
}

// The sums have room for six levels, but a file may contain more.
TEST_F(AreaPreparation, CellsFinerThanThoseOfABuildAreRefused) {
  for (std::int32_t level = 0; level <= 6; ++level)
    body.spaces[0].splits.push_back({{0, 0, 0}, level});
  test::expectBadInput([&] { area(); }, {"split more than 6 times"});
}

}  // namespace
}  // namespace palpate
