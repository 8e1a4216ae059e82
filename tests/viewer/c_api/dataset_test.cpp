#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <thread>
#include <vector>

#include "tests/viewer/c_api/sample_file.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::NanSensitiveDoubleEq;

class CDataset : public test::SharedSample {
 protected:
  palpate_sample query(int space, int method, const std::array<double, 3>& displacement) {
    auto sample = test::sized<palpate_sample>();
    EXPECT_EQ(palpate_query(shared(), space, method, displacement.data(), &sample), PALPATE_OK)
        << palpate_last_error();
    return sample;
  }
};

TEST_F(CDataset, DescribesItsContents) {
  const Dataset reference(sharedFile());
  const palpate_dataset_info info = test::describe(shared());
  EXPECT_STREQ(info.name, "sample");
  EXPECT_EQ(info.file, sharedFile().string());
  EXPECT_EQ(info.content_id, reference.contentId().hex());
  EXPECT_EQ(info.contact_mode, PALPATE_UNILATERAL);
  EXPECT_EQ(info.space_count, 2);
  EXPECT_EQ(info.method_count, 2);
  EXPECT_EQ(info.vertex_count, static_cast<std::int32_t>(reference.surfaceNodes().size()));
  EXPECT_EQ(info.triangle_count, static_cast<std::int32_t>(reference.mesh().surface.size()));
  EXPECT_EQ(info.max_force, 8.5);
  EXPECT_STREQ(palpate_dataset_method(shared(), 0), "potential");
  EXPECT_STREQ(palpate_dataset_method(shared(), 1), "trilinear");
}

TEST_F(CDataset, DescribesItsSpaces) {
  const Dataset reference(sharedFile());
  std::int32_t number = -1;
  ASSERT_EQ(palpate_dataset_find_space(shared(), "edge-2", &number), PALPATE_OK);
  EXPECT_EQ(number, 1);
  auto space = test::sized<palpate_space_info>();
  ASSERT_EQ(palpate_dataset_space(shared(), number, &space), PALPATE_OK);
  EXPECT_STREQ(space.name, "edge-2");
  EXPECT_EQ(space.node, 8);
  EXPECT_EQ(reference.surfaceNodes()[static_cast<std::size_t>(space.vertex)], 8);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(space.rest_position[i], reference.mesh().nodes[8][i]);
  EXPECT_EQ(space.workspace_radius, 0.02);
  EXPECT_EQ(space.spacing, 0.01);
  double largest = 0;
  for (const PointRecord& point : reference.spaces()[1].points)
    largest = std::max(largest, point.equilibrium.force.norm());
  EXPECT_EQ(space.largest_force, largest);
}

TEST_F(CDataset, CopiesItsSurface) {
  const Dataset reference(sharedFile());
  const auto& nodes = reference.surfaceNodes();
  const auto& triangles = reference.mesh().surface;
  std::vector<double> vertices(3 * nodes.size() + 1, -7);
  ASSERT_EQ(palpate_dataset_vertices(shared(), vertices.data(), vertices.size()), PALPATE_OK);
  for (std::size_t n = 0; n < nodes.size(); ++n)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(vertices[3 * n + i],
                reference.mesh().nodes[static_cast<std::size_t>(nodes[n])][static_cast<int>(i)]);
  EXPECT_EQ(vertices.back(), -7);

  std::vector<std::int32_t> corners(3 * triangles.size(), -1);
  ASSERT_EQ(palpate_dataset_triangles(shared(), corners.data(), corners.size()), PALPATE_OK);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(nodes[static_cast<std::size_t>(corners[3 * t + i])], triangles[t][i]);

  std::vector<std::uint8_t> touchable(triangles.size(), 9);
  ASSERT_EQ(palpate_dataset_touchable(shared(), touchable.data(), touchable.size()), PALPATE_OK);
  EXPECT_THAT(touchable, Each(::testing::Le(1)));
  EXPECT_THAT(touchable, ::testing::Contains(1));
}

TEST_F(CDataset, AnswersAsTheForceFieldDoesToTheLastBit) {
  const Dataset reference(sharedFile());
  std::mt19937 random(5);
  std::uniform_real_distribution<double> anywhere(-0.025, 0.025);
  for (std::size_t method = 0; method < 2; ++method)
    for (std::size_t space = 0; space < 2; ++space) {
      const auto field = makeForceField(forceFieldMethods()[method], reference.spaces()[space]);
      for (int n = 0; n < 200; ++n) {
        const std::array<double, 3> p = {anywhere(random), anywhere(random), anywhere(random)};
        const ForceSample expected = field->evaluate({p[0], p[1], p[2]});
        const palpate_sample sample = query(static_cast<int>(space), static_cast<int>(method), p);
        for (int i = 0; i < 3; ++i) EXPECT_EQ(sample.force[i], expected.force[i]);
        for (int i = 0; i < 9; ++i)
          EXPECT_EQ(sample.stiffness[i], expected.stiffness(i / 3, i % 3));
        EXPECT_THAT(sample.energy, NanSensitiveDoubleEq(expected.energy));
        EXPECT_THAT(sample.error_bound, NanSensitiveDoubleEq(expected.error_bound));
        EXPECT_EQ(sample.coverage, expected.coverage);
        EXPECT_EQ(sample.inside, expected.inside ? 1 : 0);
      }
    }
}

TEST_F(CDataset, AnswersManyAtOnceAsOneByOne) {
  constexpr std::size_t count = 50;
  std::vector<double> displacements, forces(3 * count), stiffnesses(9 * count), energies(count),
      bounds(count), coverages(count);
  std::vector<std::uint8_t> inside(count);
  for (std::size_t i = 0; i < 3 * count; ++i)
    displacements.push_back(1e-3 * std::sin(static_cast<double>(i * i)) * static_cast<double>(i));
  displacements[30] = test::nan_value;
  auto answers = test::sized<palpate_answers>();
  answers.forces = forces.data();
  answers.stiffnesses = stiffnesses.data();
  answers.energies = energies.data();
  answers.error_bounds = bounds.data();
  answers.coverages = coverages.data();
  answers.inside = inside.data();
  for (const int method : {0, 1}) {
    ASSERT_EQ(palpate_query_many(shared(), 1, method, displacements.data(), count, &answers),
              PALPATE_OK);
    for (std::size_t n = 0; n < count; ++n) {
      const double* p = &displacements[3 * n];
      palpate_sample many = test::sized<palpate_sample>();
      std::copy_n(&forces[3 * n], 3, many.force);
      std::copy_n(&stiffnesses[9 * n], 9, many.stiffness);
      many.energy = energies[n];
      many.error_bound = bounds[n];
      many.coverage = coverages[n];
      many.inside = inside[n];
      EXPECT_TRUE(test::sameBits(many, query(1, method, {p[0], p[1], p[2]}))) << n;
    }
  }
}

TEST_F(CDataset, WritesOnlyRequestedArraysUpToTheCount) {
  const double displacements[6] = {0.001, 0, 0, 0, 0.002, 0};
  double forces[9];
  std::ranges::fill(forces, 7);
  auto answers = test::sized<palpate_answers>();
  ASSERT_EQ(palpate_query_many(shared(), 0, 0, displacements, 2, &answers), PALPATE_OK);
  answers.forces = forces;
  ASSERT_EQ(palpate_query_many(shared(), 0, 0, displacements, 0, &answers), PALPATE_OK);
  EXPECT_THAT(forces, Each(7.0));
  ASSERT_EQ(palpate_query_many(shared(), 0, 0, displacements, 2, &answers), PALPATE_OK);
  EXPECT_EQ(forces[3], query(0, 0, {0, 0.002, 0}).force[0]);
  EXPECT_THAT((std::array{forces[6], forces[7], forces[8]}), Each(7.0));
}

TEST_F(CDataset, AnswersAfterItsFileIsGone) {
  const test::SampleFile gone;
  const auto opened = test::open(gone.path());
  std::filesystem::remove(gone.path());
  const double p[3] = {0.003, 0.001, -0.002};
  auto sample = test::sized<palpate_sample>();
  ASSERT_EQ(palpate_query(opened.get(), 0, 0, p, &sample), PALPATE_OK);
  EXPECT_TRUE(test::sameBits(sample, query(0, 0, {p[0], p[1], p[2]})));
}

TEST_F(CDataset, GivesFourThreadsTheSameAnswers) {
  constexpr int count = 2000;
  const auto place = [](int n) {
    return std::array<double, 3>{1e-5 * n - 0.01, 5e-6 * n, -3e-6 * n};
  };
  std::vector<palpate_sample> expected;
  for (int n = 0; n < count; ++n) expected.push_back(query(n % 2, n / 2 % 2, place(n)));

  std::array<int, 4> different = {-1, -1, -1, -1};
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < different.size(); ++t)
    threads.emplace_back([&, t] {
      int differences = 0;
      for (int n = 0; n < count; ++n) {
        auto sample = test::sized<palpate_sample>();
        const palpate_status status =
            palpate_query(shared(), n % 2, n / 2 % 2, place(n).data(), &sample);
        differences +=
            status == PALPATE_OK && test::sameBits(sample, expected[static_cast<std::size_t>(n)])
                ? 0
                : 1;
      }
      different[t] = differences;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(different, ElementsAre(0, 0, 0, 0));
}

TEST_F(CDataset, ErrorsBelongToTheirThread) {
  std::int32_t number = 0;
  ASSERT_EQ(palpate_dataset_find_space(shared(), "nose", &number), PALPATE_INVALID_ARGUMENT);
  std::string text = "unset";
  std::thread([&] { text = palpate_last_error(); }).join();
  EXPECT_EQ(text, "");
  EXPECT_THAT(palpate_last_error(), AllOf(HasSubstr("nose"), HasSubstr("tip, edge-2")));
}

TEST_F(CDataset, AnswersNanWithoutForceAndWithoutAnError) {
  for (const int method : {0, 1}) {
    const palpate_sample sample = query(0, method, {test::nan_value, 0.001, 0});
    EXPECT_THAT(sample.force, Each(0.0));
    EXPECT_THAT(sample.stiffness,
                Each(::testing::Truly([](double k) { return std::isfinite(k); })));
    EXPECT_EQ(sample.inside, 0);
  }
  std::vector<float> shape(3 * static_cast<std::size_t>(test::describe(shared()).vertex_count), 5);
  const double displacement[3] = {0, test::nan_value, 0};
  std::int32_t inside = 1;
  ASSERT_EQ(palpate_displacements(shared(), 0, displacement, shape.data(), shape.size(), &inside),
            PALPATE_OK);
  EXPECT_EQ(inside, 0);
  EXPECT_THAT(shape, Each(0.0F));
}

TEST_F(CDataset, GivesTheShapeOfASolvedPoint) {
  const Dataset reference(sharedFile());
  const SpaceTable& space = reference.spaces()[1];
  const std::vector<float> solved = reference.surfaceFields(1).displacement;
  const std::size_t row = 3 * reference.surfaceNodes().size();
  std::vector<float> shape(row);
  const Eigen::Vector3d p = space.lattice.displacement(4);
  std::int32_t inside = 0;
  ASSERT_EQ(palpate_displacements(shared(), 1, p.data(), shape.data(), row, &inside), PALPATE_OK);
  EXPECT_EQ(inside, 1);
  for (std::size_t i = 0; i < row; ++i) EXPECT_NEAR(shape[i], solved[4 * row + i], 1e-8);
}

TEST_F(CDataset, PreparesTheRequestedMethods) {
  const char* const methods[] = {"tricubic", "potential"};
  auto options = test::sized<palpate_open_options>();
  options.methods = methods;
  options.method_count = 2;
  const auto dataset = test::open(sharedFile(), &options);
  EXPECT_STREQ(palpate_dataset_method(dataset.get(), 0), "tricubic");
  std::int32_t method = -1;
  ASSERT_EQ(palpate_dataset_find_method(dataset.get(), "potential", &method), PALPATE_OK);
  EXPECT_EQ(method, 1);
  EXPECT_EQ(palpate_dataset_find_method(dataset.get(), "trilinear", &method),
            PALPATE_INVALID_ARGUMENT);
  EXPECT_THAT(palpate_last_error(),
              AllOf(HasSubstr("trilinear"), HasSubstr("tricubic, potential")));
  EXPECT_EQ(method, 1);
}

/// The error message of opening a file, which must fail.
std::string complaint(palpate_status expected, const std::filesystem::path& file,
                      const palpate_open_options* options = nullptr) {
  int anything = 0;
  palpate_dataset* dataset = reinterpret_cast<palpate_dataset*>(&anything);
  EXPECT_EQ(palpate_dataset_open(file.c_str(), options, &dataset), expected);
  EXPECT_EQ(dataset, nullptr);
  return palpate_last_error();
}

TEST_F(CDataset, RefusesFilesThatAreNotDatasets) {
  const test::TemporaryDirectory directory;
  EXPECT_THAT(complaint(PALPATE_BAD_FILE, directory / "absent.h5"), HasSubstr("absent.h5"));
  EXPECT_THAT(complaint(PALPATE_BAD_FILE, directory.path()), HasSubstr(directory.path().string()));
  std::ofstream(directory / "text.h5") << "not a dataset\n";
  EXPECT_THAT(complaint(PALPATE_BAD_FILE, directory / "text.h5"), HasSubstr("not an HDF5 file"));
  std::filesystem::copy_file(sharedFile(), directory / "cut.h5");
  std::filesystem::resize_file(directory / "cut.h5", std::filesystem::file_size(sharedFile()) / 2);
  EXPECT_THAT(complaint(PALPATE_BAD_FILE, directory / "cut.h5"), HasSubstr("cut.h5"));
}

TEST_F(CDataset, RefusesInvalidOptions) {
  const char* methods[] = {"potential", "quadrilinear"};
  auto options = test::sized<palpate_open_options>();
  options.methods = methods;
  options.method_count = 2;
  EXPECT_THAT(complaint(PALPATE_INVALID_ARGUMENT, sharedFile(), &options),
              AllOf(HasSubstr("quadrilinear"), HasSubstr("rbf-cubic")));
  methods[1] = nullptr;
  EXPECT_THAT(complaint(PALPATE_INVALID_ARGUMENT, sharedFile(), &options), HasSubstr("methods"));
  options.methods = nullptr;
  EXPECT_THAT(complaint(PALPATE_INVALID_ARGUMENT, sharedFile(), &options), HasSubstr("methods"));
  options = test::sized<palpate_open_options>();
  for (const double reach : {-0.01, test::nan_value, std::numeric_limits<double>::infinity()}) {
    options.reach = reach;
    EXPECT_THAT(complaint(PALPATE_INVALID_ARGUMENT, sharedFile(), &options), HasSubstr("reach"));
  }
  options = test::sized<palpate_open_options>();
  for (const std::size_t size : {std::size_t{0}, sizeof options - 1, sizeof options + 8}) {
    options.size = size;
    EXPECT_THAT(complaint(PALPATE_INVALID_ARGUMENT, sharedFile(), &options),
                AllOf(HasSubstr("options->size"), HasSubstr(std::to_string(sizeof options))));
  }
}

#define EXPECT_INVALID(call, text)             \
  EXPECT_EQ((call), PALPATE_INVALID_ARGUMENT); \
  EXPECT_THAT(palpate_last_error(), HasSubstr(text))

TEST_F(CDataset, RefusesNullPointers) {
  const double p[3] = {0, 0, 0};
  float shape[3];
  auto sample = test::sized<palpate_sample>();
  auto info = test::sized<palpate_dataset_info>();
  auto space = test::sized<palpate_space_info>();
  palpate_dataset* dataset = nullptr;
  std::int32_t number = 0;
  EXPECT_INVALID(palpate_dataset_open(nullptr, nullptr, &dataset), "file is NULL");
  EXPECT_INVALID(palpate_dataset_open(sharedFile().c_str(), nullptr, nullptr), "dataset is NULL");
  EXPECT_INVALID(palpate_dataset_describe(nullptr, &info), "dataset is NULL");
  EXPECT_INVALID(palpate_dataset_describe(shared(), nullptr), "info is NULL");
  EXPECT_INVALID(palpate_dataset_space(nullptr, 0, &space), "dataset is NULL");
  EXPECT_INVALID(palpate_dataset_space(shared(), 0, nullptr), "info is NULL");
  EXPECT_INVALID(palpate_dataset_find_space(shared(), nullptr, &number), "name is NULL");
  EXPECT_INVALID(palpate_dataset_find_space(shared(), "tip", nullptr), "space is NULL");
  EXPECT_INVALID(palpate_dataset_find_method(nullptr, "potential", &number), "dataset is NULL");
  EXPECT_EQ(palpate_dataset_method(nullptr, 0), nullptr);
  EXPECT_INVALID(palpate_query(nullptr, 0, 0, p, &sample), "dataset is NULL");
  EXPECT_INVALID(palpate_query(shared(), 0, 0, nullptr, &sample), "displacement is NULL");
  EXPECT_INVALID(palpate_query(shared(), 0, 0, p, nullptr), "sample is NULL");
  auto answers = test::sized<palpate_answers>();
  EXPECT_INVALID(palpate_query_many(nullptr, 0, 0, p, 1, &answers), "dataset is NULL");
  EXPECT_INVALID(palpate_query_many(shared(), 0, 0, nullptr, 1, &answers), "displacements is NULL");
  EXPECT_INVALID(palpate_query_many(shared(), 0, 0, p, 1, nullptr), "answers is NULL");
  answers.triangles = &number;
  EXPECT_INVALID(palpate_query_many(shared(), 0, 0, p, 1, &answers), "triangles");
  answers.triangles = nullptr;
  double distance = 0;
  answers.distances = &distance;
  EXPECT_INVALID(palpate_query_many(shared(), 0, 0, p, 1, &answers), "distances");
  EXPECT_INVALID(palpate_displacements(nullptr, 0, p, shape, 3, nullptr), "dataset is NULL");
  EXPECT_INVALID(palpate_displacements(shared(), 0, p, nullptr, 3, nullptr),
                 "displacements is NULL");
  EXPECT_INVALID(palpate_dataset_vertices(shared(), nullptr, 3), "vertices is NULL");
  palpate_dataset_close(nullptr);
}

TEST_F(CDataset, RefusesIndicesOutOfRange) {
  const double p[3] = {0, 0, 0};
  auto sample = test::sized<palpate_sample>();
  auto space = test::sized<palpate_space_info>();
  sample.force[0] = 42;
  EXPECT_INVALID(palpate_query(shared(), 2, 0, p, &sample),
                 "space 2 does not exist; valid numbers are 0 to 1");
  EXPECT_INVALID(palpate_query(shared(), -1, 0, p, &sample), "space -1 ");
  EXPECT_INVALID(palpate_query(shared(), 0, 2, p, &sample), "method 2 ");
  EXPECT_EQ(sample.force[0], 42);
  const auto answers = test::sized<palpate_answers>();
  EXPECT_INVALID(palpate_query_many(shared(), 2, 0, p, 1, &answers), "space 2 ");
  EXPECT_INVALID(palpate_query_many(shared(), 0, 5, p, 1, &answers), "method 5 ");
  EXPECT_INVALID(palpate_dataset_space(shared(), 7, &space), "space 7 ");
  EXPECT_EQ(palpate_dataset_method(shared(), -1), nullptr);
  EXPECT_THAT(palpate_last_error(), HasSubstr("method -1 "));
}

TEST_F(CDataset, RefusesUnknownStructureSizes) {
  const double p[3] = {0, 0, 0};
  palpate_sample sample{};
  EXPECT_INVALID(palpate_query(shared(), 0, 0, p, &sample), "sample->size is 0");
  sample.size = sizeof sample + 8;
  EXPECT_INVALID(palpate_query(shared(), 0, 0, p, &sample), "sample->size is 144, not 136");
  EXPECT_EQ(sample.coverage, 0);
  palpate_answers answers{};
  EXPECT_INVALID(palpate_query_many(shared(), 0, 0, p, 1, &answers), "answers->size is 0");
}

TEST_F(CDataset, RefusesSmallBuffersAndLeavesThemUnchanged) {
  const double p[3] = {0.001, 0, 0};
  const palpate_dataset_info info = test::describe(shared());
  std::vector<float> shape(3 * static_cast<std::size_t>(info.vertex_count) - 1, 7);
  EXPECT_INVALID(
      palpate_displacements(shared(), 0, p, shape.data(), shape.size(), nullptr),
      std::to_string(shape.size()) + " numbers, but " + std::to_string(shape.size() + 1));
  EXPECT_THAT(shape, Each(7.0F));
  std::vector<double> vertices(5, 7);
  EXPECT_INVALID(palpate_dataset_vertices(shared(), vertices.data(), 5), "holds 5 numbers");
  EXPECT_THAT(vertices, Each(7.0));
  std::vector<std::int32_t> triangles(5, 7);
  EXPECT_INVALID(palpate_dataset_triangles(shared(), triangles.data(), 5), "holds 5 numbers");
  EXPECT_THAT(triangles, Each(7));
  std::uint8_t touchable = 7;
  EXPECT_INVALID(palpate_dataset_touchable(shared(), &touchable, 1), "holds 1 numbers");
  EXPECT_EQ(touchable, 7);
}

}  // namespace
}  // namespace palpate
