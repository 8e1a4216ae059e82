#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "tests/support/command.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/touchable_body.hpp"
#include "tests/system/process.hpp"
#include "tests/viewer/picture/person.hpp"
#include "tests/viewer/picture/virtual_screen.hpp"

/// The haptic client as started by a person, without a display.
namespace palpate {
namespace {

using test::Process;
using ::testing::HasSubstr;

struct ViewTest : testing::Test {
  test::TemporaryDirectory directory;

  ViewTest() {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    seal(1);
  }

  /// A cube that is touchable all over its top, `factor` times as stiff as the softest.
  void seal(double factor) const {
    const Mesh mesh = test::cubeMesh(0.1, 2);
    std::vector<test::TouchableBody::Active> active;
    for (const std::int32_t node : mesh.node_groups.at("zmax")) active.push_back({node, factor});
    test::TouchableBody(mesh, active).seal(directory / "cube.h5");
  }
  std::unique_ptr<Process> start(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "view");
    return std::make_unique<Process>("palpate-viewer", std::move(arguments), directory.path());
  }
  /// The measurements of a successful run as JSON.
  nlohmann::json measured(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--headless", "--json"});
    auto run = start(std::move(arguments));
    return measuredBy(*run);
  }
  /// The measurements of a successful run that was started with --json.
  static nlohmann::json measuredBy(Process& run, int code = 0) {
    EXPECT_EQ(run.wait(), code) << run.output();
    const std::string output = run.output();
    const std::size_t begin = output.find('{');
    return begin == std::string::npos
               ? nlohmann::json()
               : nlohmann::json::parse(output.substr(begin, output.find('\n', begin) - begin));
  }
  std::string content(const char* file) const { return test::contentOf(directory / file); }
};

TEST_F(ViewTest, TheVirtualHandTouchesTheSameToTheBitInEveryRun) {
  const auto first = measured({"cube.h5", "--fast", "--duration", "4", "--record", "first.h5"});
  EXPECT_EQ(first.at("ticks"), 4000);
  EXPECT_GE(first.at("contacts"), 1);
  EXPECT_GT(first.at("largest_force"), 0.05);
  measured({"cube.h5", "--fast", "--duration", "4", "--record", "second.h5"});
  EXPECT_EQ(content("first.h5"), content("second.h5"));
}

TEST_F(ViewTest, AReplayGivesTheSameForcesAgain) {
  measured({"cube.h5", "--fast", "--duration", "2", "--record", "run.h5"});
  const auto replayed =
      measured({"cube.h5", "--fast", "--device", "replay:run.h5", "--record", "again.h5"});
  EXPECT_EQ(replayed.at("ticks"), 2000);
  const auto compared =
      test::runCommand("cd '" + directory.path().string() +
                       "' && /usr/bin/python3 -c \"import h5py; a, b = h5py.File('run.h5'), "
                       "h5py.File('again.h5'); print('equal' if (a['/force/rendered'][:] == "
                       "b['/force/rendered'][:]).all() else 'no')\"");
  EXPECT_EQ(compared.output, "equal\n");
}

TEST_F(ViewTest, EndsAfterItsDurationOnTheClock) {
  const auto run = measured({"cube.h5", "--duration", "0.5"});
  EXPECT_EQ(run.at("ticks"), 500);
}

TEST_F(ViewTest, AnInterruptOrClosedTerminalKeepsItsResults) {
  for (const int number : {SIGINT, SIGHUP}) {
    std::filesystem::remove(directory / "run.h5");
    auto run = start({"cube.h5", "--headless", "--record", "run.h5"});
    ASSERT_TRUE(test::says(*run, "virtual hand at"));
    EXPECT_EQ(run->stop(number), 130);
    EXPECT_THAT(run->output(), HasSubstr("latency"));
    EXPECT_TRUE(std::filesystem::exists(directory / "run.h5"));
  }
}

TEST_F(ViewTest, AClosedPipeKeepsTheRecording) {
  const auto run = test::runCommand(
      "cd '" + directory.path().string() + "' && " +
      PALPATE_BIN_DIR
      "/palpate-viewer view cube.h5 --headless --fast --duration 1 --record run.h5 | true");
  EXPECT_EQ(run.exit_code, 0) << "the exit code of true, which reads nothing: " << run.output;
  EXPECT_TRUE(std::filesystem::exists(directory / "run.h5"));
}

TEST_F(ViewTest, AnUnwritablePictureFolderKeepsTheRecording) {
  const test::VirtualScreen screen;
  auto run = start({"cube.h5", "--record-video", "frames", "--record", "run.h5"});
  ASSERT_TRUE(test::eventually(
      [&] { return std::filesystem::exists(directory / "frames/frame-000003.png"); }));
  std::error_code busy;
  while (std::filesystem::exists(directory / "frames"))
    std::filesystem::remove_all(directory / "frames", busy);
  EXPECT_EQ(run->wait(), 1);
  EXPECT_THAT(run->output(), HasSubstr("frames/frame-"));
  EXPECT_TRUE(std::filesystem::exists(directory / "run.h5"));
}

TEST_F(ViewTest, ReplacingTheDatasetMeanwhileChangesNothing) {
  auto run = start({"cube.h5", "--headless", "--duration", "2.5", "--record", "run.h5"});
  ASSERT_TRUE(test::says(*run, "virtual hand at"));
  seal(2);
  EXPECT_EQ(run->wait(), 0) << run->output();
  EXPECT_THAT(run->output(), HasSubstr("cube.h5 was replaced"));
}

TEST_F(ViewTest, ARecordingDoesNotReplaceItsDataset) {
  const std::string before = content("cube.h5");
  auto run = start({"cube.h5", "--headless", "--duration", "0.1", "--record", "./cube.h5"});
  EXPECT_EQ(run->wait(), 2);
  EXPECT_THAT(run->output(), HasSubstr("--record ./cube.h5: is the input cube.h5"));
  EXPECT_EQ(content("cube.h5"), before);
}

TEST_F(ViewTest, SaysWhatToDoWithoutADisplay) {
  auto run = start({"cube.h5", "--duration", "1"});
  EXPECT_EQ(run->wait(), 1);
  EXPECT_THAT(run->output(), HasSubstr("--headless"));
}

TEST_F(ViewTest, ReportsAWrongDeviceBeforeOpeningTheDisplay) {
  auto run = start({"cube.h5", "--device", "falcon"});
  EXPECT_EQ(run->wait(), 2);
  EXPECT_THAT(run->output(), HasSubstr("--device falcon"));
  EXPECT_THAT(run->output(), testing::Not(HasSubstr("--headless")));
}

TEST_F(ViewTest, WritesTheSamePicturesInEveryRunWithoutAClock) {
  const test::VirtualScreen screen;
  for (const std::string name : {"first", "second"}) {
    auto run = start({"cube.h5", "--fast", "--duration", "1.2", "--screenshot", name + ".png",
                      "--record-video", name + "-frames"});
    EXPECT_EQ(run->wait(), 0) << run->output();
  }
  EXPECT_GT(content("first.png").size(), 10000u);
  EXPECT_EQ(content("first.png"), content("second.png"));
  EXPECT_EQ(content("first-frames/frame-000030.png"), content("second-frames/frame-000030.png"));
  EXPECT_NE(content("first-frames/frame-000010.png"), content("first-frames/frame-000030.png"));
}

TEST_F(ViewTest, DrawsWhileTheLoopKeepsItsTime) {
  const test::VirtualScreen screen;
  auto run = start({"cube.h5", "--duration", "1", "--screenshot", "end.png", "--json"});
  EXPECT_EQ(run->wait(), 0) << run->output();
  EXPECT_THAT(run->output(), HasSubstr("\"ticks\":1000,"));
  EXPECT_GT(content("end.png").size(), 10000u);
}

TEST_F(ViewTest, APersonWithAMousePressesTheBodyInTheWindow) {
  const test::VirtualScreen screen;
  auto run = start({"cube.h5", "--duration", "5", "--json"});
  ASSERT_TRUE(test::says(*run, "mouse at"));
  test::Person person(screen.name(), "Palpate");
  person.pointAt(490, 311);
  person.holdButton();
  const nlohmann::json measured = measuredBy(*run);
  EXPECT_EQ(measured.at("contacts"), 1);
  EXPECT_GT(measured.at("largest_force"), 0.1);
}

/// Regression: Q was lost while forces were being prepared.
TEST_F(ViewTest, QEndsItAsSoonAsThereIsAWindow) {
  const test::VirtualScreen screen;
  std::vector<std::string> arguments(40, "cube.h5");
  arguments.insert(arguments.end(), {"--method", "rbf-cubic"});
  auto run = start(arguments);
  std::unique_ptr<test::Person> person;
  ASSERT_TRUE(test::eventually([&] {
    try {
      person = std::make_unique<test::Person>(screen.name(), "Palpate");
    } catch (const Error&) {
    }
    return person != nullptr;
  }));
  person->press("q");
  ASSERT_TRUE(test::eventually([&] { return !run->running(); })) << run->output();
  EXPECT_EQ(run->wait(), 0);
}

/// Regression: F5 prepared forces in the drawing thread, so Ctrl-C was ignored.
TEST_F(ViewTest, CtrlCEndsItSoonWhileDatasetsAreReloaded) {
  const test::VirtualScreen screen;
  using Clock = std::chrono::steady_clock;
  std::vector<std::string> arguments(20, "cube.h5");
  arguments.insert(arguments.end(), {"--method", "rbf-cubic"});
  const auto begin = Clock::now();
  auto run = start(arguments);
  ASSERT_TRUE(test::says(*run, "mouse at"));
  const auto prepared = Clock::now() - begin;
  test::Person person(screen.name(), "Palpate");
  person.press("F5");
  std::this_thread::sleep_for(prepared / 8);
  const auto asked = Clock::now();
  run->signal(SIGINT);
  EXPECT_EQ(run->wait(), 130) << run->output();
  EXPECT_LT(Clock::now() - asked, prepared / 2);
}

TEST_F(ViewTest, FeelsReloadedDatasets) {
  const test::VirtualScreen screen;
  std::filesystem::copy(directory / "cube.h5", directory / "soft.h5");
  auto run = start({"cube.h5", "--device", "virtual", "--json"});
  ASSERT_TRUE(test::says(*run, "virtual hand at"));
  seal(4);
  test::Person person(screen.name(), "Palpate");
  // Reloading runs at the lowest priority, so other tests on this machine can delay it for minutes.
  const std::chrono::minutes limit(5);
  const auto again = [&] {
    person.press("F5");  // a window ignores keys before its first frame
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    return run->output().find("reloaded") != std::string::npos;
  };
  ASSERT_TRUE(test::eventually(again, limit)) << run->output();
  const double soft =
      measured({"soft.h5", "--fast", "--duration", "8"}).at("largest_force").get<double>();
  std::this_thread::sleep_for(std::chrono::seconds(8));
  run->signal(SIGINT);
  EXPECT_GT(measuredBy(*run, 130).at("largest_force"), 1.5 * soft);
}

TEST_F(ViewTest, RefusesInvalidArguments) {
  struct Case {
    std::vector<std::string> arguments;
    int code;
    const char* says;
  };
  const std::vector<Case> cases = {
      {{"nothing.h5"}, 2, "nothing.h5"},
      {{"cube.h5", "--method", "magic"}, 2, "potential"},
      {{"cube.h5", "--rate", "7"}, 2, "--rate"},
      {{"cube.h5", "--fast"}, 2, "--duration"},
      {{"cube.h5", "--fast", "--duration", "1", "--device", "haply"}, 2, "--fast"},
      {{"cube.h5", "--device", "mouse"}, 2, "--headless"},
      {{"cube.h5", "--device", "vitrual"}, 2, "virtual"},
      {{"cube.h5", "--device", "replay:none.h5"}, 2, "none.h5"},
      {{"cube.h5", "--duration", "0.1", "--record", "nowhere/run.h5"}, 1, "nowhere"},
  };
  for (Case one : cases) {
    one.arguments.insert(one.arguments.end(), "--headless");
    auto run = start(one.arguments);
    EXPECT_EQ(run->wait(), one.code) << run->output();
    EXPECT_THAT(run->output(), HasSubstr(one.says));
  }
}

}  // namespace
}  // namespace palpate
