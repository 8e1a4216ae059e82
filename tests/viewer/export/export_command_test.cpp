#include "viewer/export/export_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "common/base/whole_file.hpp"
#include "common/dataset/hdf5_handle.hpp"
#include "tests/support/command.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// As in the program: one of these tests fills a disk.
[[maybe_unused]] const bool exit_leaves_exported = (hdf5::leaveOpenFilesAtExit(), true);

/// A sealed sample dataset to export.
class ExportCommand : public ::testing::Test {
 protected:
  ExportCommand() { sample.seal(options.dataset); }

  ExitCode run(const std::string& lines = "") {
    std::istringstream input(lines);
    std::ostringstream output;
    const ExitCode code = exportConfigurations(options, input, output);
    told = output.str();
    return code;
  }
  void storeAll() {
    sample.problem.scene.storage.displacement = StoredNodes::all;
    sample.seal(options.dataset);
  }
  std::string written() const { return readText(options.output, "file"); }
  std::vector<std::string> linesWritten() const {
    std::istringstream text(written());
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(line);
    return lines;
  }
  /// Expects only the dataset to exist.
  void expectNothingIsLeft() const {
    for (const auto& entry : std::filesystem::directory_iterator(directory.path()))
      EXPECT_EQ(entry.path(), options.dataset);
  }

  test::TemporaryDirectory directory;
  test::SampleDataset sample;
  ExportOptions options{
      directory / "sample.h5", directory / "touch.vtu", "edge-2", {"0.001", "-0.002", "0"}};
  std::string told;
};

TEST_F(ExportCommand, WritesTheSurfaceAndSaysHowToGetTheVolume) {
  EXPECT_EQ(run(), ExitCode::done);
  EXPECT_THAT(told,
              AllOf(HasSubstr("26 points, 48 triangles"), HasSubstr("displacement = \"all\"")));
  EXPECT_THAT(written(),
              AllOf(HasSubstr("Name=\"displacement\""), HasSubstr("Name=\"touched\""),
                    Not(HasSubstr("Name=\"det_F\"")), Not(HasSubstr("Name=\"pressure\"")),
                    HasSubstr("scene=\"sample\" active=\"edge-2\" method=\"potential\"")));
}

TEST_F(ExportCommand, WritesTheVolumeIfAllNodesAreStored) {
  storeAll();
  EXPECT_EQ(run(), ExitCode::done);
  EXPECT_THAT(told, AllOf(HasSubstr("27 points, 48 tetrahedra"), Not(HasSubstr("storage"))));
  EXPECT_THAT(written(), AllOf(HasSubstr("Name=\"det_F\""), HasSubstr("Name=\"pressure\"")));
}

TEST_F(ExportCommand, WritesASolvedPointWithItsNumbers) {
  options.displacement.clear();
  options.point = {1, 0, -1};
  EXPECT_EQ(run(), ExitCode::done);
  EXPECT_THAT(written(), AllOf(HasSubstr("method=\"solved\""), HasSubstr("Name=\"lattice_point\""),
                               HasSubstr("Name=\"min_det_F\"")));
}

TEST_F(ExportCommand, SaysWhyThereIsNoConfiguration) {
  options.active = "tip";
  options.displacement.clear();
  const LatticePoint failed = sample.lattice.point(7), unknown = sample.lattice.point(32);
  options.point = {failed.begin(), failed.end()};
  expectBadInput([&] { run(); },
                 {"sample.h5", "tip", "failed (wrong_inertia)", "palpate explain", "--active tip"});
  options.point = {unknown.begin(), unknown.end()};
  expectBadInput([&] { run(); }, {"tip", "unknown"});
  options.point = {3, 0, 0};
  expectBadInput([&] { run(); }, {"(3, 0, 0) is not in the lattice"});
  expectNothingIsLeft();
}

TEST_F(ExportCommand, WritesASeriesAndItsListLast) {
  options.output = directory / "press.pvd";
  options.steps = 3;
  EXPECT_EQ(run(), ExitCode::done);
  EXPECT_THAT(told, HasSubstr("4 files in"));
  for (int n = 0; n < 4; ++n) {
    const std::string file = fmt::format("press/press_{:04}.vtu", n);
    EXPECT_THAT(written(), HasSubstr(fmt::format(
                               "timestep=\"{}\" group=\"\" part=\"0\" file=\"{}\"", n, file)));
    EXPECT_THAT(readText(directory / file, "file"), HasSubstr("Name=\"way\""));
  }
  EXPECT_FALSE(std::filesystem::exists(directory / "press/press_0004.vtu"));
  options.steps = 1;
  expectBadInput([&] { run(); }, {"press already exists"});
  options.replace = true;
  EXPECT_EQ(run(), ExitCode::done);
  EXPECT_FALSE(std::filesystem::exists(directory / "press/press_0002.vtu")) << "of the longer one";
}

TEST_F(ExportCommand, AFullDiskIsReportedWithTheFileAndLeavesNothing) {
  options.output = directory / "touch.vtu";
  // The temporary file goes to a full device.
  std::filesystem::create_symlink("/dev/full", directory / "touch.vtu.tmp");
  test::expectError(ExitCode::failed, [&] { run(); }, {"touch.vtu", "No space left on device"});
  expectNothingIsLeft();
}

TEST_F(ExportCommand, AMissingFolderIsNamed) {
  options.output = directory / "nowhere" / "touch.vtu";
  test::expectError(ExitCode::failed, [&] { run(); }, {"nowhere", "give another -o"});
}

TEST_F(ExportCommand, RefusesIncompleteOrContradictoryOptions) {
  options.output = directory / "touch.obj";
  expectBadInput([&] { run(); }, {"touch.obj", ".vtu", ".pvd", ".csv"});
  options.output = directory / "press.pvd";
  expectBadInput([&] { run(); }, {"press.pvd", "--steps N"});
  options.output = directory / "curve.csv";
  expectBadInput([&] { run(); }, {"curve.csv", "--steps N"});
  options.steps = -1;
  expectBadInput([&] { run(); }, {"--steps -1"});
  options.output = directory / "touch.vtu";
  expectBadInput([&] { run(); }, {"touch.vtu", "one configuration", ".pvd or .csv"});
  options.steps = 0;
  options.point = {0, 0, 0};
  expectBadInput([&] { run(); }, {"--displacement X Y Z", "--point I J K"});
  options.displacement.clear();
  options.output = directory / "press.pvd";
  expectBadInput([&] { run(); }, {"press.pvd", "--point"});
  options.output = directory / "touch.vtu";
  options.method = "trilinear";
  expectBadInput([&] { run(); }, {"--method trilinear", "--point"});
  options.point.clear();
  expectBadInput([&] { run(); }, {"--displacement X Y Z", "--point I J K"});
  expectNothingIsLeft();
}

TEST_F(ExportCommand, RefusesUnknownNamesMethodsAndDatasets) {
  options.active = "top";
  expectBadInput([&] { run(); }, {"\"top\"", "tip, edge-2"});
  options.active = "tip";
  options.method = "cubic";
  expectBadInput([&] { run(); }, {"cubic", "potential, trilinear"});
  options.method = "potential";
  options.at = {"0", "0", "0"};
  expectBadInput([&] { run(); }, {"--at", "\"tip\" is not a finger"});
  options.at.clear();
  options.dataset = directory / "other.h5";
  expectBadInput([&] { run(); }, {"other.h5", "no such dataset"});
}

TEST_F(ExportCommand, ProgramReadsItsArgumentsAndReturnsItsExitCodes) {
  const std::string words = fmt::format("{}/palpate-answers export {} --active edge-2 ",
                                        PALPATE_BIN_DIR, options.dataset.string());
  const std::string out = fmt::format("-o {} ", options.output.string());
  test::CommandResult result = test::runCommand(words + out + "--displacement -0.01 -1e-3 -.002");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  result = test::runCommand(words + out + "--point -1 0 0");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("already exists"));
  result = test::runCommand(words + out + "--point -1 0 0 --replace");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  result = test::runCommand(words + out + "--displacement 0.5 0 0 --replace");
  EXPECT_EQ(result.exit_code, 3) << result.output;
  EXPECT_THAT(result.output, HasSubstr("1 of 1 touch"));
  EXPECT_EQ(test::runCommand(words + out + "--point 1 0").exit_code, 2);
  result = test::runCommand(std::string(PALPATE_BIN_DIR) + "/palpate-answers export --help");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.output, HasSubstr(".pvd"));
}

/// A dataset whose top is touched by a finger.
class ExportOfAFinger : public ExportCommand {
 protected:
  ExportOfAFinger() {
    body.seal(options.dataset);
    options.active = "top";
  }
  test::FingerBody body;
};

TEST_F(ExportOfAFinger, ACurveHasPlaceAndConfigurationalForce) {
  expectBadInput([&] { run(); }, {"\"top\"", "--at X Y Z"});
  options.output = directory / "curve.csv";
  options.at = options.displacement = {"-"};
  EXPECT_EQ(run("0.05 0.04 0.1 0 0 -0.01\n0.02 0.08 0.1, 0.001 0 -0.002\n"), ExitCode::done);
  EXPECT_THAT(linesWritten().front(),
              AllOf(HasSubstr("way_m,at_x_m,"), HasSubstr("drive_z_N,energy_J")));
  EXPECT_EQ(linesWritten().size(), 3U);
  options.replace = true;
  EXPECT_EQ(run("0.05 0.04 0.1 0 0 -0.01\n0.05 0.04 0.104 0 0 -0.01\n"), ExitCode::done);
  EXPECT_THAT(linesWritten().back(), StartsWith("1,0,0.05,0.04,0.1,"))
      << "the tool has not moved: both places are the same point of the surface";
}

}  // namespace
}  // namespace palpate
