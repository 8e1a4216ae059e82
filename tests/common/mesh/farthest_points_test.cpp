#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/mesh/near_points.hpp"

namespace palpate {
namespace {

std::vector<Eigen::Vector3d> line(int count) {
  std::vector<Eigen::Vector3d> places;
  for (int n = 0; n < count; ++n) places.emplace_back(0.01 * n, 0, 0);
  return places;
}

std::vector<double> apart(std::size_t count, double distance) {
  return std::vector<double>(count, distance);
}

const auto every_place = [](const Eigen::Vector3d&, std::size_t) { return true; };

TEST(FarthestPoints, AreTakenFarthestFirstUntilNoneIsFar) {
  const auto taken = farthestPoints(line(11), apart(11, 0.026), every_place);
  EXPECT_THAT(taken, ::testing::ElementsAre(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.1, 0, 0),
                                            Eigen::Vector3d(0.05, 0, 0)));
}

TEST(FarthestPoints, AreDenserWhereTheirDistanceIsSmaller) {
  auto distances = apart(11, 0.026);
  for (std::size_t n = 6; n < 11; ++n) distances[n] = 0.011;
  int near = 0, far = 0;
  for (const Eigen::Vector3d& place : farthestPoints(line(11), distances, every_place))
    ++(place.x() < 0.055 ? near : far);
  EXPECT_EQ(near, 2);
  EXPECT_GE(far, 3);
}

TEST(FarthestPoints, LeaveOutRefusedPoints) {
  const auto taken =
      farthestPoints(line(11), apart(11, 0.026),
                     [](const Eigen::Vector3d& place, std::size_t) { return place.x() < 0.095; });
  for (const Eigen::Vector3d& place : taken) EXPECT_LT(place.x(), 0.095);
  EXPECT_EQ(taken.at(1).x(), 0.09);
}

TEST(FarthestPoints, ReportHowManyWereTakenSoFar) {
  std::size_t most = 0;
  farthestPoints(line(11), apart(11, 0.011), [&](const Eigen::Vector3d&, std::size_t taken) {
    most = std::max(most, taken);
    return true;
  });
  EXPECT_GT(most, 3u);
}

TEST(FarthestPoints, AreEmptyWithoutPlaces) {
  EXPECT_TRUE(farthestPoints({}, {}, every_place).empty());
}

}  // namespace
}  // namespace palpate
