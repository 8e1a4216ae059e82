#include "viewer/query/query_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/command.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A sealed sample dataset for queries.
class QueryCommand : public ::testing::Test {
 protected:
  QueryCommand() { sample.seal(options.dataset); }

  ExitCode ask(const std::string& lines = "") {
    std::istringstream input(lines);
    std::ostringstream output;
    const ExitCode code = query(options, input, output);
    answer = output.str();
    return code;
  }

  /// Runs the program itself and returns its exit code; standard output and error are in `answer`.
  int run(const std::string& arguments) {
    const test::CommandResult result =
        test::runCommand(PALPATE_BIN_DIR "/palpate-answers query " + arguments);
    answer = result.output;
    return result.exit_code;
  }

  ForceSample expected(const std::string& method, const Eigen::Vector3d& p) const {
    return makeForceField(method, sample.spaces[1])->evaluate(p);
  }

  test::TemporaryDirectory directory;
  test::SampleDataset sample;
  QueryOptions options{
      directory / "sample.h5", "edge-2", {"0.001", "-0.002", "0"}, "potential", true};
  std::string answer;
};

TEST_F(QueryCommand, AnswersInJsonWithNumbersThatRoundTrip) {
  for (const std::string& method : forceFieldMethods()) {
    options.method = method;
    EXPECT_EQ(ask(), ExitCode::done);
    const ForceSample sampled = expected(method, {0.001, -0.002, 0});
    const auto found = nlohmann::json::parse(answer);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      EXPECT_EQ(found.at("force").at(i), sampled.force[row]);
      for (std::size_t j = 0; j < 3; ++j)
        EXPECT_EQ(found.at("stiffness").at(i).at(j),
                  sampled.stiffness(row, static_cast<Eigen::Index>(j)));
    }
    for (const auto& [name, number] :
         {std::pair("energy", sampled.energy), std::pair("error_bound", sampled.error_bound)})
      EXPECT_EQ(found.at(name), std::isfinite(number) ? nlohmann::json(number) : nlohmann::json());
    EXPECT_EQ(found.at("coverage"), sampled.coverage);
    EXPECT_EQ(found.at("inside"), true);
    EXPECT_EQ(found.at("method"), method);
  }
}

TEST_F(QueryCommand, AnswersOneLinePerLine) {
  options.displacement = {"-"};
  EXPECT_EQ(ask("0.001 0 0\n\n  0.001,\t0 , 1e-3\r\n+0.002 -0.001 -.001"), ExitCode::done);
  std::istringstream lines(answer);
  std::vector<std::string> answers;
  for (std::string line; std::getline(lines, line);) answers.push_back(line);
  ASSERT_EQ(answers.size(), 3u);
  EXPECT_THAT(answers[1], StartsWith("{\"displacement\":[0.001,0.0,0.001],\"force\":["));
  EXPECT_THAT(answers[2], StartsWith("{\"displacement\":[0.002,-0.001,-0.001],\"force\":["));
}

TEST_F(QueryCommand, NamesTheLineItCannotRead) {
  options.displacement = {"-"};
  for (const char* line : {"0 0", "0 0 0 0", "0 0 x", "0 nan 0", "0 0 1e999", "0 0 0.1m"})
    expectBadInput([&] { ask(std::string("0 0 0\n\n") + line + "\n0 0 0\n"); },
                   {"standard input, line 3"});
}

TEST_F(QueryCommand, MarksOutsideAnswersAndEndsWithCodeThree) {
  options.displacement = {"-"};
  EXPECT_EQ(ask("0 0 0\n0.03 0 0\n"), ExitCode::partly_failed);
  EXPECT_THAT(answer, HasSubstr("\"inside\":true"));
  EXPECT_THAT(answer, HasSubstr("\"inside\":false"));
}

TEST_F(QueryCommand, ShowsAPersonWhichNeighboursAreMissing) {
  options.json = false;
  options.active = "tip";
  const LatticePoint failed = sample.lattice.point(7);
  options.displacement.clear();
  for (const std::int32_t coordinate : failed)
    options.displacement.push_back(fmt::format("{}", 0.005 * coordinate));
  EXPECT_EQ(ask(), ExitCode::done);
  EXPECT_THAT(answer, HasSubstr(fmt::format("({}, {}, {}) failed (wrong_inertia)", failed[0],
                                            failed[1], failed[2])));
}

TEST_F(QueryCommand, ShowsForceAndMagnitudeToAPerson) {
  options.json = false;
  EXPECT_EQ(ask(), ExitCode::done);
  const double magnitude = expected("potential", {0.001, -0.002, 0}).force.norm();
  EXPECT_THAT(answer, HasSubstr(fmt::format("{:.6g} N", magnitude)));
}

TEST_F(QueryCommand, AsksForTheActiveNodeOnlyWhenThereAreSeveral) {
  options.active = "";
  expectBadInput([&] { ask(); }, {"--active", "tip, edge-2"});
  sample.problem.scene.active.resize(1);
  sample.problem.active.resize(1);
  sample.spaces.resize(1);
  sample.seal(options.dataset);
  EXPECT_EQ(ask(), ExitCode::done);
  options.active = "top";
  expectBadInput([&] { ask(); }, {"\"top\"", "tip"});
}

TEST_F(QueryCommand, RefusesUnknownMethodsAndMissingDatasets) {
  options.method = "cubic";
  expectBadInput([&] { ask(); }, {"cubic", "potential, trilinear"});
  options.dataset = directory / "other.h5";
  expectBadInput([&] { ask(); }, {"other.h5", "no such dataset"});
}

TEST_F(QueryCommand, ProgramTakesNegativeNumbersAnywhere) {
  const std::string file = options.dataset.string();
  EXPECT_EQ(run(file + " --active edge-2 --displacement -0.01 -1e-3 -.002 --json"), 0) << answer;
  EXPECT_THAT(answer, StartsWith("{\"displacement\":[-0.01,-0.001,-0.002],"));
  const std::string first = answer;
  EXPECT_EQ(run("--json --displacement -0.01 -1e-3 -.002 " + file + " --active edge-2"), 0)
      << answer;
  EXPECT_EQ(answer, first);
}

TEST_F(QueryCommand, ProgramReadsStandardInputAndReturnsItsExitCodes) {
  const std::string file = options.dataset.string(), lines = (directory / "lines").string();
  std::ofstream(lines) << "-0.01 -1e-3 -.002\n0 0 0.5\n";
  EXPECT_EQ(run(file + " --active edge-2 --displacement - --json < " + lines), 3) << answer;
  EXPECT_THAT(answer, StartsWith("{\"displacement\":[-0.01,-0.001,-0.002],"));
  EXPECT_EQ(run(file + " --active edge-2 --displacement 0 0"), 2);
  EXPECT_EQ(run(file + " --active edge-2"), 2);
  EXPECT_EQ(run("--help"), 0);
}

/// A dataset whose top is touched by a finger.
class QueryOfAFinger : public QueryCommand {
 protected:
  QueryOfAFinger() {
    static const test::TemporaryDirectory sealed;
    options.dataset = sealed / "finger.h5";
    if (!std::filesystem::exists(options.dataset)) test::FingerBody().seal(options.dataset);
    options.active = "top";
  }
};

TEST_F(QueryOfAFinger, AnswersAnywhereOnTheSurface) {
  options.at = {"0.0512", "0.0437", "0.104"};
  options.displacement = {"0.003", "-0.002", "-0.009"};
  EXPECT_EQ(ask(), ExitCode::done);
  const auto found = nlohmann::json::parse(answer);
  const Eigen::Vector3d s(0.0512, 0.0437, 0.1), p(0.003, -0.002, -0.009);
  const Eigen::Vector3d force = test::FingerBody::force(s, p),
                        drive = test::FingerBody::drive(s, p);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    EXPECT_NEAR(found.at("at").at(axis).get<double>(), s[a], 1e-12) << "the nearest point above";
    EXPECT_NEAR(found.at("force").at(axis).get<double>(), force[a], 0.01);
    EXPECT_NEAR(found.at("drive").at(axis).get<double>(), drive[a], 0.01);
  }
  EXPECT_NEAR(found.at("energy").get<double>(), test::FingerBody::energy(s, p), 1e-4);
  EXPECT_EQ(found.at("inside"), true);
  EXPECT_NEAR(found.at("distance").get<double>(), 0.004, 1e-12);
}

TEST_F(QueryOfAFinger, SaysThatAPlaceIsAwayFromTheSurface) {
  options.at = {"0.05", "0.05", "0.078"};
  options.displacement = {"0", "0", "-0.01"};
  EXPECT_EQ(ask(), ExitCode::partly_failed);
  EXPECT_THAT(answer, HasSubstr("\"inside\":false"));
  EXPECT_NEAR(nlohmann::json::parse(answer).at("distance").get<double>(), 0.022, 1e-12);
}

TEST_F(QueryOfAFinger, ReadsSixNumbersPerLine) {
  options.at = options.displacement = {"-"};
  EXPECT_EQ(ask("0.05 0.04 0.1 0 0 -0.01\n0.02 0.08 0.1, 0.001 0 -0.002\n"), ExitCode::done);
  EXPECT_EQ(std::ranges::count(answer, '\n'), 2);
  expectBadInput([&] { ask("0.05 0.04 0.1\n"); }, {"line 1", "six numbers"});
}

TEST_F(QueryOfAFinger, SaysWhereThereIsNoAnswer) {
  options.at = {"0.05", "0.05", "0"};
  options.displacement = {"0", "0", "0.001"};
  EXPECT_EQ(ask(), ExitCode::partly_failed);
  options.at = {"0.05", "0.05", "0.1"};
  options.displacement = {"0", "0", "0.025"};
  EXPECT_EQ(ask(), ExitCode::partly_failed) << "nobody pulls";
  options.displacement = {"0", "0", "-0.04"};
  EXPECT_EQ(ask(), ExitCode::partly_failed);
}

TEST_F(QueryOfAFinger, NeedsAPlaceAndOnlyItsOwnMethod) {
  expectBadInput([&] { ask(); }, {"\"top\"", "--at X Y Z"});
  options.at = {"0.05", "0.05", "0.1"};
  options.method = "trilinear";
  expectBadInput([&] { ask(); }, {"--method trilinear", "only potential"});
  options.method = "potential";
  options.at = {"5", "0.05", "0.1"};
  expectBadInput([&] { ask(); }, {"--at", "more than the body is wide"});
}

TEST_F(QueryCommand, ANodeTakesNoPlace) {
  options.at = {"0.05", "0.05", "0.1"};
  expectBadInput([&] { ask(); }, {"--at", "\"edge-2\" is not a finger"});
}

}  // namespace
}  // namespace palpate
