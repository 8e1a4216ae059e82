#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/problem/finger.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/viewer/c_api/counting_malloc.hpp"
#include "tests/viewer/c_api/sample_file.hpp"
#include "viewer/answers/force_answers.hpp"

namespace palpate {
namespace {

using ::testing::HasSubstr;

/// A cube whose top is touched by a finger.
class CArea : public ::testing::Test {
 protected:
  struct File {
    File() { body.seal(path()); }
    std::filesystem::path path() const { return directory.path() / "fingered.h5"; }
    test::FingerBody body;
    test::TemporaryDirectory directory;
  };
  static palpate_dataset* dataset() {
    static const File file;
    static const test::DatasetHandle handle = test::open(file.path());
    return handle.get();
  }

  palpate_area_sample query(const Eigen::Vector3d& place, const Eigen::Vector3d& p) {
    auto sample = test::sized<palpate_area_sample>();
    EXPECT_EQ(palpate_area_query(dataset(), 0, place.data(), p.data(), &sample), PALPATE_OK)
        << palpate_last_error();
    return sample;
  }
};

TEST_F(CArea, DescribesItselfAndRefusesUnknownNames) {
  std::int32_t count = -1, number = -1;
  ASSERT_EQ(palpate_dataset_area_count(dataset(), &count), PALPATE_OK);
  EXPECT_EQ(count, 1);
  ASSERT_EQ(palpate_dataset_find_area(dataset(), "top", &number), PALPATE_OK);
  EXPECT_EQ(number, 0);
  auto info = test::sized<palpate_area_info>();
  ASSERT_EQ(palpate_dataset_area(dataset(), 0, &info), PALPATE_OK);
  EXPECT_STREQ(info.name, "top");
  EXPECT_EQ(info.finger_radius, 0.02);
  EXPECT_EQ(info.workspace_radius, 0.03);
  EXPECT_EQ(info.site_count, test::describe(dataset()).space_count);
  const double x[3] = {0, 0, 0};
  auto sample = test::sized<palpate_area_sample>();
  const auto refused = [](palpate_status status, const char* why) {
    EXPECT_EQ(status, PALPATE_INVALID_ARGUMENT);
    EXPECT_THAT(palpate_last_error(), HasSubstr(why));
  };
  refused(palpate_area_query(dataset(), 1, x, x, &sample),
          "area 1 does not exist; valid numbers are 0 to 0");
  refused(palpate_area_query(dataset(), 0, nullptr, x, &sample), "at is NULL");
  refused(palpate_area_query(dataset(), 0, x, nullptr, &sample), "displacement is NULL");
  refused(palpate_dataset_find_area(dataset(), "top-0", &number), "area \"top-0\"; known: top");
  refused(palpate_dataset_area_count(dataset(), nullptr), "count is NULL");
  info.size = 8;
  refused(palpate_dataset_area(dataset(), 0, &info), "info->size is 8");
  const test::SampleFile of_nodes;
  const test::DatasetHandle nodes = test::open(of_nodes.path());
  ASSERT_EQ(palpate_dataset_area_count(nodes.get(), &number), PALPATE_OK);
  EXPECT_EQ(number, 0);
  refused(palpate_area_query(nodes.get(), 0, x, x, &sample), "no area");
}

TEST_F(CArea, AnswersForPlacesWhoseSquaredDistanceOverflows) {
  const palpate_area_sample sample = query({0, 0, 1e200}, {0, 0, -0.01});
  EXPECT_EQ(sample.inside, 0);
  EXPECT_EQ(sample.distance, 1e200);
  EXPECT_GE(sample.triangle, 0);
  EXPECT_NEAR(sample.at[2], 0.1, 1e-9);
  EXPECT_TRUE(Eigen::Vector3d(sample.force).allFinite());
}

/// Regression: millimetres given as metres, points inside the body and beside it were answered
/// without notice.
TEST_F(CArea, IsNotInsideOffTheSurfaceAndGivesTheDistance) {
  const Eigen::Vector3d p(0, 0, -0.01);
  for (const auto& [z, inside] : {std::pair(0.1049, 1),
                                  {0.1051, 0},
                                  {0.0951, 1},
                                  {0.0949, 0},
                                  {0.05, 0},
                                  {50.0, 0},
                                  {1e6, 0}}) {
    const palpate_area_sample sample = query({0.05, 0.05, z}, p);
    EXPECT_EQ(sample.inside, inside) << z;
    EXPECT_NEAR(sample.distance, std::abs(z - 0.1), 1e-12 * (1 + z));
    EXPECT_TRUE(Eigen::Vector3d(sample.force).allFinite());
  }
  // A caller that was compiled before `distance` was added.
  auto older = test::sized<palpate_area_sample>();
  older.size = offsetof(palpate_area_sample, distance);
  older.distance = 7;
  const double place[3] = {0.05, 0.05, 0.2};
  ASSERT_EQ(palpate_area_query(dataset(), 0, place, p.data(), &older), PALPATE_OK);
  EXPECT_EQ(older.inside, 0);
  EXPECT_EQ(older.distance, 7);
}

/// Regression: the programs checked for fixed nodes, but the C API only looked at the triangle.
TEST_F(CArea, AnswersAsTheProgramsDoEvenNearFixedNodes) {
  const test::FingerBody beside(0, "xmin");
  const test::TemporaryDirectory directory;
  beside.seal(directory / "beside.h5");
  const Dataset sealed(directory / "beside.h5");
  const ForceAnswers answers(sealed, "top", true, "potential");
  const test::DatasetHandle opened = test::open(directory / "beside.h5");
  const Eigen::Vector3d p(0.001, 0.002, -0.009);
  using Stiffness = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
  int fixed = 0, inside = 0;
  for (int n = 0; n < 500; ++n) {
    const Eigen::Vector3d near(1e-3 * (n % 40) - 0.004, 0.05 + 2e-3 * (n % 7),
                               0.1 - (n % 3) * 4e-3 - (n % 11 == 0 ? 0.01 : 0));
    auto sample = test::sized<palpate_area_sample>();
    ASSERT_EQ(palpate_area_query(opened.get(), 0, near.data(), p.data(), &sample), PALPATE_OK);
    const ForceAnswer answer = answers.answer({near, p});
    EXPECT_EQ(sample.inside == 1, answer.sample.inside) << near.transpose();
    EXPECT_EQ(Eigen::Vector3d(sample.force), answer.sample.force);
    EXPECT_EQ(Eigen::Vector3d(sample.drive), answer.finger->drive);
    EXPECT_EQ(Eigen::Vector3d(sample.at), answer.finger->at);
    EXPECT_EQ(sample.distance, answer.finger->distance);
    EXPECT_EQ(Stiffness(sample.stiffness), answer.sample.stiffness);
    inside += sample.inside;
    if (sample.inside == 1) {
      EXPECT_EQ(sample.energy, answer.sample.energy);
      EXPECT_EQ(sample.error_bound, answer.sample.error_bound);
    }
    if (answer.finger->fault != FingerPlace::Fault::fixed) continue;
    ++fixed;
    EXPECT_EQ(sample.inside, 0);
    EXPECT_LT(fingerWeights(sealed.mesh(), sealed.fixedNodes(), answer.finger->at, 0.02).free_share,
              least_free_share);
  }
  EXPECT_GT(fixed, 20);
  EXPECT_GT(inside, 100);
}

TEST_F(CArea, AnswersManyPlacesAtOnceAsOneByOneEvenInPlace) {
  std::vector<double> places, displacements;
  for (int n = 0; n < 20; ++n) {
    for (const double x : {5e-3 * n, 0.04 + 1e-3 * n, n == 7 ? test::nan_value : 0.11})
      places.push_back(x);
    for (const double p : {1e-4 * n, -2e-4 * n, -1e-3 * n}) displacements.push_back(p);
  }
  const std::vector<double> asked = places;
  std::vector<double> forces(60), drives(60), bounds(20), distances(20);
  std::vector<std::int32_t> triangles(20);
  auto answers = test::sized<palpate_answers>();
  answers.forces = forces.data();
  answers.drives = drives.data();
  answers.places = places.data();
  answers.triangles = triangles.data();
  answers.error_bounds = bounds.data();
  answers.distances = distances.data();
  ASSERT_EQ(
      palpate_area_query_many(dataset(), 0, places.data(), displacements.data(), 20, &answers),
      PALPATE_OK);
  for (std::size_t n = 0; n < 20; ++n) {
    const palpate_area_sample one =
        query(Eigen::Vector3d::Map(&asked[3 * n]), Eigen::Vector3d::Map(&displacements[3 * n]));
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(forces[3 * n + i], one.force[i]);
      EXPECT_EQ(drives[3 * n + i], one.drive[i]);
      EXPECT_EQ(places[3 * n + i], one.at[i]);
    }
    EXPECT_EQ(triangles[n], one.triangle);
    EXPECT_TRUE(bounds[n] == one.error_bound || (n == 7 && std::isnan(bounds[n])));
    EXPECT_TRUE(distances[n] == one.distance || (n == 7 && std::isnan(distances[n])));
  }
  EXPECT_EQ(palpate_area_query_many(dataset(), 1, places.data(), places.data(), 1, &answers),
            PALPATE_INVALID_ARGUMENT);
  EXPECT_EQ(palpate_area_query_many(dataset(), 0, nullptr, places.data(), 1, &answers),
            PALPATE_INVALID_ARGUMENT);
  EXPECT_THAT(palpate_last_error(), HasSubstr("places is NULL"));
}

TEST_F(CArea, IsNotInsideBeyondItsSurfaceOrBallAndAllocatesNowhere) {
  const Eigen::Vector3d top(0.05, 0.05, 0.1), p(0, 0, -0.01);
  EXPECT_EQ(query({0.05, 0.05, -0.1}, p).inside, 0);
  EXPECT_EQ(query(top, 4 * p).inside, 0);
  for (const palpate_area_sample& none :
       {query({test::nan_value, 0, 0}, p), query(top, {0, test::nan_value, 0})}) {
    EXPECT_EQ(none.inside, 0);
    EXPECT_EQ(Eigen::Vector3d(none.force), Eigen::Vector3d::Zero());
    EXPECT_EQ(none.triangle, -1);
    EXPECT_TRUE(std::isnan(none.energy) && std::isnan(none.error_bound));
    EXPECT_TRUE(std::isnan(none.distance));
  }
  auto sample = test::sized<palpate_area_sample>();
  palpate_dataset* const opened = dataset();
  int failures = 0;
  const long before = test::allocationCount();
  for (int n = 0; n < 100; ++n) {
    const double place[3] = {1e-3 * n, 0.05, 0.1},
                 by[3] = {0, 0, n == 50 ? test::nan_value : -4e-4 * n};
    failures += palpate_area_query(opened, 0, place, by, &sample) == PALPATE_OK ? 0 : 1;
  }
  EXPECT_EQ(test::allocationCount(), before);
  EXPECT_EQ(failures, 0);
}

}  // namespace
}  // namespace palpate
