#include "viewer/fields/hermite_kernel.hpp"

#include <gtest/gtest.h>

#include "tests/viewer/fields/area_sample.hpp"

namespace palpate {
namespace {

using test::PaperArea;

/// The ten quantities of the paper energy at one displacement.
Eigen::VectorXf quantitiesAt(const std::vector<Eigen::Vector3d>& places) {
  const Eigen::Vector3d p(0.01, -0.004, 0.006);
  Eigen::VectorXf all(place_quantities * static_cast<Eigen::Index>(places.size()));
  Eigen::Index row = 0;
  for (const Eigen::Vector3d& s : places) {
    const Eigen::Vector3d drive = PaperArea::drive(s, p);
    const Eigen::Matrix3d slope = -PaperArea::f(p) * PaperArea::hessianG(s);
    all[row++] = static_cast<float>(PaperArea::energy(s, p));
    for (int axis = 0; axis < 3; ++axis) all[row++] = static_cast<float>(drive[axis]);
    for (const auto& [a, b] : symmetric_axes) all[row++] = static_cast<float>(slope(a, b));
  }
  return all;
}

const std::vector<Eigen::Vector3d> some_sites = {{0, 0, 0},
                                                 {0.014, 0.001, 0.002},
                                                 {0.003, 0.015, -0.001},
                                                 {-0.012, 0.008, 0},
                                                 {0.01, -0.011, 0}};

TEST(HermiteKernelTest, HasExactEnergiesAndCloseDerivativesAtTheSites) {
  const Eigen::VectorXf data = quantitiesAt(some_sites);
  const float steepest = quantitiesAt({some_sites.back()}).tail<6>().norm();
  for (std::size_t s = 0; s < some_sites.size(); ++s) {
    const Eigen::VectorXf found =
        hermiteWeights(some_sites[s], some_sites, 0.03).coefficients * data;
    const Eigen::VectorXf exact = quantitiesAt({some_sites[s]});
    EXPECT_NEAR(found[0], exact[0], 1e-5 * exact[0]);
    EXPECT_LT((found.segment<3>(1) - exact.segment<3>(1)).norm(),
              1e-3 * exact.segment<3>(1).norm());
    EXPECT_LT((found.tail<6>() - exact.tail<6>()).norm(), 0.05 * steepest);
  }
}

TEST(HermiteKernelTest, InterpolatesAllTenQuantitiesBetweenThem) {
  const Eigen::VectorXf data = quantitiesAt(some_sites);
  const Eigen::Vector3d between(0.004, 0.005, 0);
  const Eigen::VectorXf found = hermiteWeights(between, some_sites, 0.03).coefficients * data,
                        exact = quantitiesAt({between});
  EXPECT_NEAR(found[0], exact[0], 1e-3 * exact[0]);
  EXPECT_LT((found.segment<3>(1) - exact.segment<3>(1)).norm(), 0.02 * exact.segment<3>(1).norm());
  EXPECT_LT((found.tail<6>() - exact.tail<6>()).norm(), 0.4 * exact.tail<6>().norm());
}

TEST(HermiteKernelTest, OrdersDifferByMoreThanTheErrorExceptAtTheSites) {
  const Eigen::VectorXf data = quantitiesAt(some_sites);
  const auto differenceAt = [&](const Eigen::Vector3d& place) {
    return std::abs(hermiteWeights(place, some_sites, 0.03).order_difference.dot(data));
  };
  for (const Eigen::Vector3d& site : some_sites) EXPECT_LT(differenceAt(site), 1e-5F * data[0]);
  for (const double x : {-0.008, -0.004, 0.004, 0.008})
    for (const double y : {-0.008, -0.004, 0.004, 0.008}) {
      const Eigen::Vector3d place(x, y, 0);
      const float error =
          std::abs((hermiteWeights(place, some_sites, 0.03).coefficients * data)[0] -
                   quantitiesAt({place})[0]);
      EXPECT_GT(differenceAt(place), error) << place.transpose();
      EXPECT_LT(differenceAt(place), 0.05F * data[0]) << place.transpose();
    }
}

TEST(HermiteKernelTest, KeepsTheEnergiesOfSitesWhoseDerivativesContradictEachOther) {
  Eigen::VectorXf data = quantitiesAt(some_sites);
  // A configurational force and a slope with the wrong sign.
  data.segment<9>(place_quantities + 1) *= -1;
  const auto errorAt = [&](const Eigen::Vector3d& place) {
    return std::abs((hermiteWeights(place, some_sites, 0.03).coefficients * data)[0] -
                    quantitiesAt({place})[0]);
  };
  for (const Eigen::Vector3d& site : some_sites) EXPECT_LT(errorAt(site), 1e-4F * data[0]);
}

}  // namespace
}  // namespace palpate
