#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include "common/base/whole_file.hpp"
#include "tests/support/command.hpp"
#include "tests/support/long_tests.hpp"
#include "tests/verification/case.hpp"
#include "tests/verification/meshes.hpp"
#include "tests/verification/quadrature.hpp"

namespace palpate::verification {

/// How the parameter of a test is printed.
void PrintTo(const Case& problem, std::ostream* out) {  // NOLINT(readability-identifier-naming)
  *out << problem.name;
}

namespace {

using test::runCommand;

/// The problems of `palpate verify`, one test each.
class Verification : public ::testing::TestWithParam<Case> {
 protected:
  static std::vector<Row> holdToItsTolerances() {
    std::vector<Row> rows = rowsOf(GetParam());
    EXPECT_FALSE(rows.empty());
    for (const Row& row : rows)
      EXPECT_TRUE(row.ok()) << row.name << ": " << row.computed << " " << row.unit << ", should be "
                            << row.reference << " to " << row.tolerance;
    return rows;
  }
};
class LongVerification : public Verification {};
class HardCase : public Verification {};

/// The names of a problem's rows in a table that `palpate verify` printed.
std::vector<std::string> rowsInTable(const std::string& table, const std::string& problem) {
  std::vector<std::string> rows;
  std::istringstream lines(readText(std::string(PALPATE_SOURCE_DIR "/docs/tables/") + table, ""));
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  ")) inside = line.starts_with(problem + " (");
    if (inside && line.starts_with("  ")) {
      const std::string row = line.substr(2, 64);
      rows.push_back(row.substr(0, row.find_last_not_of(' ') + 1));
    }
  }
  return rows;
}

TEST_P(Verification, IsWithinItsTolerances) { holdToItsTolerances(); }

TEST_P(HardCase, IsReachedWithItsForceAndStandsInTheTable) {
  std::vector<std::string> rows;
  for (const Row& row : holdToItsTolerances()) rows.push_back(row.name);
  EXPECT_EQ(rowsInTable("verify-hard.txt", GetParam().name), rows)
      << "write the output of palpate verify --hard there";
}

TEST_P(LongVerification, IsWithinItsTolerances) {
  if (!test::longTestsAreWanted())
    GTEST_SKIP() << "this problem takes long and was NOT checked; "
                    "set PALPATE_LONG_TESTS=1 (deploy/test --nightly does)";
  holdToItsTolerances();
}

std::vector<Case> casesThat(bool take_long) {
  std::vector<Case> chosen;
  for (const Case& problem : cases())
    if (problem.takes_long == take_long) chosen.push_back(problem);
  return chosen;
}

std::string testName(const ::testing::TestParamInfo<Case>& info) {
  std::string name = info.param.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Problem, Verification, ::testing::ValuesIn(casesThat(false)), testName);
INSTANTIATE_TEST_SUITE_P(Problem, LongVerification, ::testing::ValuesIn(casesThat(true)), testName);
INSTANTIATE_TEST_SUITE_P(Problem, HardCase, ::testing::ValuesIn(hardCases()), testName);

TEST(VerificationRow, IsOkWithinItsToleranceAndNeverWithoutANumber) {
  EXPECT_NEAR((Row{"", 2.02, 2, 0, ""}.deviation()), 0.01, 1e-15);
  EXPECT_NEAR((Row{"", -2.02, -2, 0, ""}.deviation()), 0.01, 1e-15);
  EXPECT_EQ((Row{"", 1e-3, 0, 0, ""}.deviation()), 1e-3) << "absolute, where the reference is zero";
  EXPECT_TRUE((Row{"", 2.02, 2, 0.011, ""}.ok()));
  EXPECT_FALSE((Row{"", 2.02, 2, 0.009, ""}.ok()));
  EXPECT_FALSE((Row{"", std::nan(""), 2, 1, ""}.ok()));
}

TEST(VerificationRow, ACaseThatThrowsIsAFailedRow) {
  const std::vector<Row> rows = rowsOf(
      {"broken", false, []() -> std::vector<Row> { throw std::runtime_error("no equilibrium"); }});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_FALSE(rows[0].ok());
  EXPECT_EQ(rows[0].name, "broken: no equilibrium");
}

TEST(VerificationMeshes, HaveTheirVolumesToSecondOrder) {
  constexpr double pi = std::numbers::pi, octant = pi / 6 * (8 - 1), tube = pi / 4 * (4 - 1) * 0.5;
  const auto error = [](const Mesh& mesh, double volume) {
    return 1 - measure(mesh).volume / volume;
  };
  EXPECT_NEAR(error(cookMesh(3, 0.001), 0.048 * (0.044 + 0.016) / 2 * 0.001), 0, 1e-12);
  for (const int n : {4, 8}) {
    EXPECT_LT(error(cylinderMesh(2, 3, n, 2), pi * 4 * 3), 0.8 / (n * n));
    EXPECT_GT(error(cylinderMesh(2, 3, n, 2), pi * 4 * 3), 0);
    EXPECT_LT(error(quarterTubeMesh(1, 2, 0.5, n), tube), 0.8 / (n * n));
    EXPECT_LT(error(sphereOctantMesh(1, 2, n), octant), 1.6 / (n * n));
  }
}

TEST(VerificationQuadrature, IntegratesPolynomialsOfDegreeSevenOverATetrahedron) {
  Mesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.tetrahedra = {{0, 1, 2, 3}};
  finishMesh(mesh, "one tetrahedron");
  double integral = 0;
  integrate(mesh, [&](const IntegrationPoint& point) {
    integral +=
        point.weight * std::pow(point.X[0], 3) * std::pow(point.X[1], 2) * std::pow(point.X[2], 2);
  });
  EXPECT_NEAR(integral, 6.0 * 2 * 2 / 3628800, 1e-15) << "3! 2! 2! / 10!";
}

TEST(VerifyCommand, PrintsOneObjectPerRowAndEndsWithZeroWhenAllAreOk) {
  const std::string program = PALPATE_BIN_DIR "/palpate-verify verify ";
  const auto result = runCommand(program + "homogeneous-st-venant --json");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  const auto row = nlohmann::json::parse(result.output.substr(0, result.output.find('\n')));
  EXPECT_EQ(row["problem"], "homogeneous-st-venant-kirchhoff");
  EXPECT_NEAR(row["computed"].get<double>(), -2229.12, 0.01);
  EXPECT_TRUE(row["ok"].get<bool>());
  const auto table = runCommand(program + "homogeneous-st-venant");
  EXPECT_THAT(table.output, ::testing::HasSubstr("3 rows ok, 0 not ok"));
}

TEST(VerifyCommand, RunsAHardCaseByItsName) {
  const auto result =
      runCommand(PALPATE_BIN_DIR "/palpate-verify verify --hard hard-contrast --json");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, ::testing::HasSubstr("\"row\":\"bone of 1e+10 Pa"));
}

TEST(VerifyCommand, RefusesAProblemItDoesNotHave) {
  const auto result = runCommand(PALPATE_BIN_DIR "/palpate-verify verify perpetuum-mobile");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, ::testing::HasSubstr("perpetuum-mobile"));
}

}  // namespace
}  // namespace palpate::verification
