#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "common/scene/scene.hpp"
#include "tests/support/blob_on_disk.hpp"
#include "tests/support/command.hpp"
#include "tests/support/meshes.hpp"

namespace palpate {
namespace {

using nlohmann::json;
using test::CommandResult;
using ::testing::AllOf;
using ::testing::HasSubstr;

class SolveCommand : public ::testing::Test, protected test::BlobOnDisk {
 protected:
  CommandResult solve(const std::string& options) {
    return test::runCommand(std::string(PALPATE_BIN_DIR) + "/palpate-worker solve " + write() +
                            " " + options);
  }
  static std::pair<json, json> twoAnswers(const std::string& output) {
    std::istringstream lines(output);
    std::string first, second;
    std::getline(lines, first);
    std::getline(lines, second);
    return {json::parse(first), json::parse(second)};
  }
};

TEST_F(SolveCommand, PrintsTheWarningsAboutTheProblem) {
  scene.active[0].radius = 0;
  EXPECT_THAT(solve("--displacement 0.001 0 0").output, HasSubstr("single node (radius = 0)"));
}

TEST_F(SolveCommand, AnswersInOneJsonObjectPerLine) {
  const CommandResult result = solve("--json --displacement 0.004 -.002 0");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const json answer = json::parse(result.output);
  EXPECT_EQ(answer.at("displacement"), json({0.004, -0.002, 0.0}));
  EXPECT_TRUE(answer.at("converged"));
  EXPECT_LT(answer.at("force").at(0), 0);
  EXPECT_GT(answer.at("energy"), 0);
  EXPECT_EQ(answer.at("stiffness").size(), 3);
  EXPECT_TRUE(answer.at("failure").is_null());
}

TEST_F(SolveCommand, AnswersForAFingerAnywhereOnTheSurface) {
  scene.active[0].tool = ToolKind::finger;
  scene.active[0].radius = 0.06;  // wider than an edge, so no warning is printed
  std::ofstream(directory / "lines") << "0.1 0 0.02 -0.004 0 0\n0.05 0.07 0.01 0, -0.004, 0\n";
  const CommandResult result =
      solve("--json --at - --displacement - < " + (directory / "lines").string());
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const auto [first, there] = twoAnswers(result.output);
  EXPECT_EQ(there.at("displacement"), json({0.0, -0.004, 0.0}));
  EXPECT_LT(there.at("at").at(1), 0.069) << "on the surface below";
  EXPECT_GT(there.at("force").at(1), 0);
  EXPECT_EQ(there.at("drive").size(), 3);
  // The same place and displacement in a separate run.
  const CommandResult alone = solve("--json --at 0.1 0 0.02 --displacement -0.004 0 0");
  ASSERT_EQ(alone.exit_code, 0) << alone.output;
  EXPECT_EQ(json::parse(alone.output).at("force"), first.at("force"));
  EXPECT_THAT(solve("--at 0.1 0 0.2 --displacement -0.004 0 0").output,
              HasSubstr("away from the surface"));
}

TEST_F(SolveCommand, ExplainsAnInvalidPlace) {
  EXPECT_THAT(solve("--at 0.1 0 0 --displacement 0.001 0 0").output, HasSubstr("\"tip\""));
  scene.active[0].tool = ToolKind::finger;
  EXPECT_THAT(solve("--at 100 0 20 --displacement 0.001 0 0").output, HasSubstr("(100, 0, 20)"));
  EXPECT_THAT(solve("--at -0.1 0 0 --displacement 0.001 0 0").output, HasSubstr("fixed nodes"));
  EXPECT_THAT(solve("--at - --displacement 0.001 0 0").output, HasSubstr("--displacement -"));
  EXPECT_EQ(solve("--at 0.1 0 --displacement 0.001 0 0").exit_code, 2);
}

TEST_F(SolveCommand, SolvesForASecondFingerThatHolds) {
  scene.active[0].tool = ToolKind::finger;
  scene.active[0].radius = 0.06;
  const std::string words = "--json --at 0.1 0 0.02 --displacement -0.004 0 0";
  const CommandResult result = solve(words + " --hold 0 0.1 0 0 -0.005 0");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const json held = json::parse(result.output), alone = json::parse(solve(words).output);
  EXPECT_GT(held.at("hold_force").at(1), 0);
  EXPECT_NE(held.at("force"), alone.at("force"));
  EXPECT_FALSE(alone.contains("hold_force"));
  EXPECT_THAT(solve("--at 0.1 0 0.02 --displacement -0.004 0 0 --hold 0 0.1 0 0 -0.005 0").output,
              HasSubstr("force on hold"));
}

TEST_F(SolveCommand, ExplainsAHoldThatCannotBeSolved) {
  const std::string words = "--displacement -0.004 0 0 --hold ";
  EXPECT_THAT(solve(words + "0 0.1 0 0 -0.005 0").output, HasSubstr("needs a finger"));
  scene.active[0].tool = ToolKind::finger;
  scene.active[0].radius = 0.06;
  EXPECT_EQ(solve(words + "0 0.1 0").exit_code, 2);
  EXPECT_THAT(solve(words + "nan 0.1 0 0 -0.005 0").output, HasSubstr("--hold: all numbers"));
  EXPECT_THAT(solve(words + "-0.1 0 0 0 -0.005 0").output, HasSubstr("fixed nodes"));
}

TEST_F(SolveCommand, ContinuesAfterAPlaceWhereNoFingerCanStand) {
  scene.active[0].tool = ToolKind::finger;
  scene.active[0].radius = 0.06;
  std::ofstream(directory / "lines") << "-0.1 0 0 0.004 0 0\n0.1 0 0.02 -0.004 0 0\n";
  const std::string words = " --at - --displacement - < " + (directory / "lines").string();
  const CommandResult result = solve("--json" + words);
  EXPECT_EQ(result.exit_code, 3) << result.output;
  const auto [first, second] = twoAnswers(result.output);
  EXPECT_EQ(first.at("failure"), "refused");
  EXPECT_TRUE(first.at("force").is_null());
  EXPECT_THAT(first.at("why"), HasSubstr("fixed"));
  const CommandResult alone = solve("--json --at 0.1 0 0.02 --displacement -0.004 0 0");
  EXPECT_EQ(second.at("force"), json::parse(alone.output).at("force"));
  EXPECT_THAT(solve(words).output, HasSubstr("failed        refused"));
}

TEST_F(SolveCommand, NeedsAPlaceOnASurfaceOfSites) {
  scene.active[0] = {.name = "skin",
                     .radius = 0.05,
                     .tool = ToolKind::finger,
                     .surface = SurfaceSelection{.all = true}};
  EXPECT_THAT(solve("--displacement 0.001 0 0").output,
              AllOf(HasSubstr("skin"), HasSubstr("--at X Y Z")));
  const CommandResult result = solve("--active skin --at 0.1 0 0.02 --displacement -0.004 0 0");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, AllOf(HasSubstr("at            0.1"), HasSubstr("drive")));
}

TEST_F(SolveCommand, AnswersAllLinesBeforeAnUnreadableOne) {
  std::ofstream(directory / "lines") << "0.001 0 0\n\n# not a number\nx 0 0\n0.002 0 0\n";
  const CommandResult result = solve("--json --displacement - < " + (directory / "lines").string());
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, AllOf(HasSubstr("\"displacement\":[0.001,0.0,0.0]"),
                                   HasSubstr("palpate solve: standard input, line 4: \"x\"")));
  EXPECT_THAT(result.output, ::testing::Not(HasSubstr("[0.002,")));
}

TEST_F(SolveCommand, ReportsAFailureByCauseAndExitCode) {
  scene.regions[0].material = {.law = LawName::st_venant_kirchhoff, .young = 5000, .poisson = 0.3};
  scene.discretization.pressure = PressureSpace::none;
  const CommandResult result = solve("--json --displacement -0.2 0 0 --steps 1");
  EXPECT_EQ(result.exit_code, 3) << result.output;
  const json answer =
      json::parse(result.output.substr(result.output.find('{')));  // after a warning
  EXPECT_FALSE(answer.at("converged"));
  EXPECT_TRUE(answer.at("force").is_null());
  EXPECT_TRUE(answer.at("failure").is_string());
}

TEST_F(SolveCommand, RefusesMillimetresTakenForMetres) {
  const CommandResult result = solve("--displacement 10 0 0");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, AllOf(HasSubstr("(10, 0, 0) m"), HasSubstr("in metres")));
  EXPECT_EQ(solve("--displacement 1e300 0 0").exit_code, 2);
}

TEST_F(SolveCommand, AsksForTheActiveNodeOnlyWhenThereAreSeveral) {
  EXPECT_EQ(solve("--displacement 0 0 0").exit_code, 0);
  scene.active.push_back({"side", Eigen::Vector3d(0, 0.1, 0), std::nullopt, 0});
  const CommandResult missing = solve("--displacement 0 0 0");
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.output, HasSubstr("choose one with --active: tip, side"));
  EXPECT_THAT(solve("--active top --displacement 0 0 0").output, HasSubstr("there are: tip, side"));
}

TEST_F(SolveCommand, HelpSaysUnitsAndExitCodes) {
  EXPECT_THAT(solve("--help").output, AllOf(HasSubstr("Usage: palpate solve"), HasSubstr("metres"),
                                            HasSubstr("N/m"), HasSubstr("Exit codes: 0 done")));
}

TEST_F(SolveCommand, UsageErrorsNameTheVerb) {
  const CommandResult result = solve("--displacement 0 0 0 --tseps 2");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, AllOf(HasSubstr("palpate solve: "), HasSubstr("--tseps"),
                                   HasSubstr("palpate solve --help")));
}

}  // namespace
}  // namespace palpate
