#include "viewer/report/comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "common/base/whole_file.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/temporary_directory.hpp"
#include "viewer/report/report_command.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Two datasets of the same body, the second three times as stiff.
class ComparisonTest : public ::testing::Test {
 protected:
  ComparisonTest() {
    second.problem.scene.name = "stiff";
    second.problem.scene.regions[0].material.c10 *= 3;
    for (SpaceTable& space : second.spaces)
      for (PointRecord& point : space.points) {
        point.equilibrium.energy *= 3;
        point.equilibrium.force *= 3;
        point.equilibrium.stiffness *= 3;
      }
    options.report.datasets = {directory / "soft.h5", directory / "stiff.h5"};
    options.html = directory / "compare.html";
  }

  std::string run() {
    first.seal(options.report.datasets[0]);
    second.seal(options.report.datasets[1]);
    std::ostringstream output;
    report(options, output);
    return output.str();
  }
  nlohmann::json json() {
    options.json = true;
    return nlohmann::json::parse(run());
  }
  std::string page() { return readText(options.html, "page"); }

  test::TemporaryDirectory directory;
  test::SampleDataset first, second;
  ReportCommandOptions options;
};

TEST_F(ComparisonTest, ShowsHowForcesOfTwoMaterialsDiffer) {
  const nlohmann::json compared = json();
  EXPECT_THAT(compared["differences"].get<std::vector<std::string>>(), ElementsAre("material"));
  EXPECT_EQ(compared["common_nodes"], 2);
  EXPECT_THAT(compared["limits"], IsEmpty());
  for (const nlohmann::json& node : compared["nodes"]) {
    EXPECT_EQ(node["apart"], 0);
    EXPECT_GT(node["displacements"], 100);
    const double soft = node["first"]["mean_force"], stiff = node["second"]["mean_force"];
    EXPECT_NEAR(stiff, 3 * soft, 1e-9 * stiff);
    EXPECT_NEAR(node["second"]["stiffness"].get<double>(),
                3 * node["first"]["stiffness"].get<double>(), 1e-6);
    EXPECT_NEAR(node["difference"]["mean"].get<double>(), 2 * soft, 1e-9 * stiff);
    EXPECT_NEAR(node["difference"]["relative"].get<double>(), 2, 1e-9);
  }
}

TEST_F(ComparisonTest, PageHasBothOnTheSameAxesWithExactPoints) {
  run();
  const std::string html = page(), begin = "type=\"application/json\">";
  const std::size_t from = html.find(begin) + begin.size();
  const nlohmann::json shown =
      nlohmann::json::parse(html.substr(from, html.find("</script>", from) - from));
  EXPECT_EQ(shown["properties"]["material"].size(), 2U);
  const nlohmann::json& drawn = shown["drawings"];
  EXPECT_THAT(drawn["files"], ElementsAre("soft", "stiff"));
  ASSERT_EQ(drawn["everywhere"].size(), 2U);
  EXPECT_NEAR(drawn["everywhere"][0]["relative"].get<double>(), 2, 1e-5);
  ASSERT_EQ(drawn["places"].size(), 2U);
  for (const nlohmann::json& place : drawn["places"])
    for (const nlohmann::json& axis : place["axes"]) {
      ASSERT_EQ(axis.size(), 2U);
      EXPECT_EQ(axis[0]["solved"][0], axis[1]["solved"][0]) << "at the same displacements";
    }
}

TEST_F(ComparisonTest, ReportsDifferentBodiesWithTheRemedy) {
  for (Eigen::Vector3d& node : second.problem.mesh.nodes) node *= 1.5;
  const nlohmann::json compared = json();
  EXPECT_THAT(compared["differences"].get<std::vector<std::string>>(), Contains("mesh"));
  ASSERT_EQ(compared["limits"].size(), 1U);
  EXPECT_THAT(compared["limits"][0].get<std::string>(),
              AllOf(HasSubstr("meshes differ"), HasSubstr("on the same mesh")));
}

TEST_F(ComparisonTest, LeavesOutUnsharedActiveNodesAndSaysSo) {
  second.problem.scene.active[1].name = "other";
  second.problem.active[1].name = "other";
  second.spaces[1].patch.name = "other";
  const nlohmann::json compared = json();
  ASSERT_EQ(compared["nodes"].size(), 1U);
  EXPECT_EQ(compared["nodes"][0]["name"], "tip");
  EXPECT_THAT(compared["limits"][0].get<std::string>(),
              AllOf(HasSubstr("2 active nodes"), HasSubstr("[[active]]")));
}

TEST_F(ComparisonTest, IsRefusedWithoutACommonActiveNode) {
  for (std::size_t n = 0; n < 2; ++n) {
    const std::string name = fmt::format("other-{}", n);
    second.problem.scene.active[n].name = name;
    second.problem.active[n].name = name;
    second.spaces[n].patch.name = name;
  }
  expectBadInput([&] { run(); }, {"soft.h5", "stiff.h5", "no active node of the same name",
                                  "tip, edge-2", "other-0, other-1", "[[active]]"});
  EXPECT_FALSE(std::filesystem::exists(options.html));
}

TEST_F(ComparisonTest, SitesOfAFingerDoNotMatchNodes) {
  first.seal(options.report.datasets[0]);
  test::FingerBody().seal(options.report.datasets[1]);
  std::ostringstream output;
  expectBadInput([&] { report(options, output); }, {"cannot be compared", "tip"});
}

TEST_F(ComparisonTest, LeavesOutDisplacementsBeyondTheForceLimitOfEither) {
  const nlohmann::json whole = json();
  const double largest = whole["nodes"][0]["second"]["largest_force"];
  second.problem.scene.workspace.max_force = largest / 2;
  const nlohmann::json limited = json();
  EXPECT_LT(limited["nodes"][0]["displacements"], whole["nodes"][0]["displacements"]);
  EXPECT_LE(limited["nodes"][0]["second"]["largest_force"].get<double>(), largest / 2);
  EXPECT_NEAR(limited["nodes"][0]["difference"]["relative"].get<double>(), 2, 1e-9);
}

TEST_F(ComparisonTest, TakesOneMethod) {
  options.report.methods = {"trilinear"};
  EXPECT_EQ(json()["method"], "trilinear");
  options.report.methods = {"trilinear", "potential"};
  expectBadInput([&] { run(); }, {"--methods", "one method", "2"});
  options.report.methods = {"cubic"};
  expectBadInput([&] { run(); }, {"--methods", "\"cubic\"", "potential"});
}

TEST_F(ComparisonTest, IsRefusedForMoreThanTwo) {
  options.report.datasets.push_back(directory / "third.h5");
  first.seal(options.report.datasets[2]);
  expectBadInput([&] { run(); }, {"soft.h5", "stiff.h5", "material", "workspace.spacing"});
}

TEST_F(ComparisonTest, NamesASpaceWithoutSolutionsAndTheCause) {
  for (PointRecord& point : second.spaces[0].points) {
    point = {};
    point.tag = Tag::failed;
    point.cause = Cause::unreachable;
  }
  second.spaces[0].attempts.clear();
  expectBadInput([&] { run(); }, {"tip of ", "stiff.h5", "potential"});
}

}  // namespace
}  // namespace palpate
