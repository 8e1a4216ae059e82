#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/dataset/hdf5_reader.hpp"
#include "tests/support/command.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/system/process.hpp"
#include "tests/viewer/picture/person.hpp"
#include "tests/viewer/picture/virtual_screen.hpp"

/// The haptic client with a follower.
namespace palpate {
namespace {

using test::contentOf;
using test::Process;
using testing::HasSubstr;
using testing::Not;

/// A finger on the top of a cube, with a coarse dataset of four places.
class LiveTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    directory_ = std::make_unique<test::TemporaryDirectory>();
    test::writeGmsh22(test::cubeMesh(0.1, 5), *directory_ / "cube.msh");
    writeScene("cube.toml", 1300);
    writeScene("stiff.toml", 2600);
    writeScene("fine.toml", 1300, 0.002);
    writeScene("wide.toml", 1300, 0.012, 0.06);
    writeScene("areas.toml", 1300);
    std::ofstream(*directory_ / "areas.toml", std::ios::app)
        << "[[active]]\nname = \"side\"\ntool = \"finger\"\nradius = 0.03\n"
        << "surface = { sphere = { center = [0.1, 0.05, 0.05], radius = 0.02 } }\n";
    test::writeGmsh22(test::cubeMesh(0.2, 5), *directory_ / "large.msh");
    writeScene("large.toml", 1300, 0.012, 0.06, "large.msh");
    Process build("palpate-scheduler", {"build", "cube.toml", "-o", "cube.h5", "-j", "1"},
                  directory_->path());
    ASSERT_EQ(build.wait(), 0) << build.output();
  }
  static void TearDownTestSuite() { directory_.reset(); }

  static void writeScene(const char* file, double c10, double spacing = 0.012, double area = 0.02,
                         const char* mesh = "cube.msh") {
    std::ofstream(*directory_ / file)
        << "name = \"cube\"\nmesh = \"" << mesh << "\"\n"
        << "[material]\nlaw = \"mooney-rivlin\"\nc10 = " << c10 << "\nc01 = 1280.0\n"
        << "[fixed]\nbelow = { axis = \"z\", fraction = 0.05 }\n"
        << "[[active]]\nname = \"top\"\ntool = \"finger\"\nradius = 0.03\n"
        << "surface = { sphere = { center = [0.05, 0.05, 0.1], radius = " << area << " } }\n"
        << "[workspace]\nradius = 0.012\nspacing = " << spacing << "\nmax_force = 8.0\n";
  }
  static std::unique_ptr<Process> view(std::vector<std::string> more) {
    std::vector<std::string> words = {"view", "cube.h5", "--headless", "--hand-speed", "0.05"};
    words.insert(words.end(), more.begin(), more.end());
    return std::make_unique<Process>("palpate-viewer", words, directory_->path());
  }

  /// The ticks of a recording in which something was touched.
  struct Run {
    std::vector<double> time, followed, bound;
    std::vector<Eigen::Vector3d> place, displacement, force;
  };
  static Run touchesIn(const char* file) {
    hdf5::Reader in(*directory_ / file);
    in.findArrays();
    const auto touching = in.readList<std::uint8_t>("/contact/touching");
    const auto keep = [&](auto list) {
      decltype(list) kept;
      for (std::size_t n = 0; n < touching.size(); ++n)
        if (touching[n] != 0) kept.push_back(list[n]);
      return kept;
    };
    return {keep(in.readList<double>("/time")),
            keep(in.readList<double>("/contact/followed")),
            keep(in.readList<double>("/contact/error_bound")),
            keep(in.readList<Eigen::Vector3d>("/contact/anchor")),
            keep(in.readList<Eigen::Vector3d>("/contact/displacement")),
            keep(in.readList<Eigen::Vector3d>("/force/raw"))};
  }
  /// Presses a hand into the top of the cube at x for three seconds, and records it. Returns
  /// the exit code.
  static int press(const char* scene, double x, const std::string& recording,
                   const std::vector<std::string>& more = {}) {
    std::ofstream(*directory_ / "hand.txt") << fmt::format(
        "0 {0} 0.05 0.11\n0.2 {0} 0.05 0.1\n0.6 {0} 0.05 0.094\n4 {0} 0.05 0.09\n", x);
    std::vector<std::string> words = {"view", scene, "--headless", "--device", "virtual:hand.txt"};
    for (const char* word : {"--friction", "10", "--duration", "3", "--record"})
      words.emplace_back(word);
    words.push_back(recording);
    words.insert(words.end(), more.begin(), more.end());
    return Process("palpate-viewer", words, directory_->path()).wait();
  }
  /// Returns for each contact of a recording whether its first force was computed, not guessed.
  static std::vector<bool> computedAtContacts(const char* file) {
    hdf5::Reader in(*directory_ / file);
    in.findArrays();
    const auto touching = in.readList<std::uint8_t>("/contact/touching");
    const auto inside = in.readList<std::uint8_t>("/contact/inside");
    std::vector<bool> computed;
    for (std::size_t n = 1; n < touching.size(); ++n)
      if (touching[n] != 0 && touching[n - 1] == 0) computed.push_back(inside[n] != 0);
    return computed;
  }
  static test::CommandResult reported(const char* recording, const char* scene) {
    return test::runCommand(fmt::format("cd '{}' && " PALPATE_BIN_DIR
                                        "/palpate-answers report {} {} --json",
                                        directory_->path().string(), recording, scene));
  }
  /// Returns the answer of `palpate solve`. more: further options.
  static nlohmann::json solve(const char* scene, const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                              const std::string& more = "") {
    const test::CommandResult done = test::runCommand(
        fmt::format("(cd '{}' && " PALPATE_BIN_DIR "/palpate-worker solve {} --json --at {} {} {} "
                    "--displacement {} {} {} {})",
                    directory_->path().string(), scene, s[0], s[1], s[2], p[0], p[1], p[2], more));
    EXPECT_EQ(done.exit_code, 0) << done.output;
    return nlohmann::json::parse(done.output.substr(done.output.find('{')));
  }
  static Eigen::Vector3d vectorIn(const nlohmann::json& numbers) {
    return {numbers[0].get<double>(), numbers[1].get<double>(), numbers[2].get<double>()};
  }
  static Eigen::Vector3d solved(const char* scene, const Eigen::Vector3d& s,
                                const Eigen::Vector3d& p) {
    return vectorIn(solve(scene, s, p).at("force"));
  }
  /// Expects that, after the first `after` seconds of touching, most forces come from the follower
  /// and equal those of the solver.
  static void expectFollowed(const Run& run, const char* scene = "cube.toml", double after = 0.5) {
    std::vector<std::size_t> late;
    for (std::size_t n = 0; n < run.time.size(); ++n)
      if (run.time[n] > run.time.front() + after) late.push_back(n);
    ASSERT_GT(late.size(), 500u);
    const auto leads = [&](std::size_t n) { return run.followed[n] > 0.9; };
    EXPECT_GT(std::ranges::count_if(late, leads), 0.8 * static_cast<double>(late.size()));
    for (std::size_t n = late.size() / 4; n < late.size(); n += late.size() / 4) {
      const std::size_t tick = late[n];
      if (!leads(tick)) continue;
      const Eigen::Vector3d exact = solved(scene, run.place[tick], run.displacement[tick]);
      EXPECT_LT((run.force[tick] - exact).norm(), std::max(0.02, 0.02 * exact.norm()))
          << run.time[tick] << " s, bound " << run.bound[tick];
    }
  }
  static inline std::unique_ptr<test::TemporaryDirectory> directory_;
};

TEST_F(LiveTest, AHandFeelsWhatTheSolverFindsAroundIt) {
  auto run = view({"--live", "cube.toml", "--duration", "4", "--record", "run.h5"});
  ASSERT_EQ(run->wait(), 0) << run->output();
  expectFollowed(touchesIn("run.h5"));
}

TEST_F(LiveTest, AReportComparesARecordedRunWithExactSolutions) {
  auto run = view({"--live", "cube.toml", "--duration", "3", "--record", "told.h5"});
  ASSERT_EQ(run->wait(), 0) << run->output();
  const test::CommandResult done = reported("told.h5", "cube.toml");
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const auto report = nlohmann::json::parse(done.output);  // without a warning
  const std::size_t touching = touchesIn("told.h5").time.size();
  const std::size_t compared = std::min<std::size_t>(touching, 1000);
  EXPECT_EQ(report.at("touching"), touching);
  EXPECT_EQ(report.at("unsolved"), 0);
  EXPECT_EQ(report.at("all").at("count"), compared);
  for (const char* intervals : {"times", "in_contact", "speeds"}) {
    std::size_t count = 0;
    for (const auto& interval : report.at(intervals))
      count += interval.at("errors").at("count").get<std::size_t>();
    EXPECT_EQ(count, compared) << intervals;
  }
  EXPECT_LT(report.at("all").at("relative").at("median"), 0.02);
  EXPECT_GT(report.at("all").at("within_target"), 0.8);
  // The tissue of this scene is about 1.5 times as stiff as the tissue that was felt.
  const test::CommandResult stiff = reported("told.h5", "stiff.toml");
  ASSERT_EQ(stiff.exit_code, 0) << stiff.output;
  const std::size_t begin = stiff.output.find("\n{");
  ASSERT_NE(begin, std::string::npos) << "a warning comes first: " << stiff.output;
  EXPECT_GT(nlohmann::json::parse(stiff.output.substr(begin)).at("all").at("relative").at("median"),
            0.2);
  EXPECT_EQ(reported("told.h5", "large.toml").exit_code, 2) << "another body";
}

TEST_F(LiveTest, AReportSolvesEachTouchWithTheFingerOfItsArea) {
  ASSERT_EQ(press("areas.toml", 0.05, "areas.h5"), 0);
  const test::CommandResult done = reported("areas.h5", "areas.toml");
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_GT(nlohmann::json::parse(done.output).at("all").at("count"), 500);
}

TEST_F(LiveTest, AHandFeelsASceneThatNobodyHasBuilt) {
  Process run("palpate-viewer",
              {"view", "stiff.toml", "--headless", "--hand-speed", "0.05", "--duration", "4",
               "--record", "scene.h5"},
              directory_->path());
  ASSERT_EQ(run.wait(), 0) << run.output();
  expectFollowed(touchesIn("scene.h5"), "stiff.toml");
  EXPECT_FALSE(computedAtContacts("scene.h5").at(0));
}

TEST_F(LiveTest, ARecordingMovesASecondFinger) {
  ASSERT_EQ(press("wide.toml", 0.026, "first.h5"), 0);
  ASSERT_EQ(press("wide.toml", 0.074, "pinch.h5", {"--hold", "first.h5"}), 0);
  hdf5::Reader in(*directory_ / "pinch.h5");
  in.findArrays();
  const auto place = in.readList<Eigen::Vector3d>("/contact/anchor"),
             displacement = in.readList<Eigen::Vector3d>("/contact/displacement"),
             force = in.readList<Eigen::Vector3d>("/force/raw"),
             hold_place = in.readList<Eigen::Vector3d>("/hold/anchor"),
             hold_displacement = in.readList<Eigen::Vector3d>("/hold/displacement"),
             hold_force = in.readList<Eigen::Vector3d>("/hold/force");
  const auto bound = in.readList<double>("/contact/error_bound"),
             hold_bound = in.readList<double>("/hold/error_bound");
  const Run first = touchesIn("first.h5");
  std::vector<std::size_t> known;
  for (std::size_t n = 0; n < hold_force.size(); ++n)
    if (hold_force[n].allFinite() && bound[n] < 0.1 * force[n].norm()) known.push_back(n);
  ASSERT_GT(known.size(), 500u);
  for (const std::size_t n : {known[known.size() / 4], known[known.size() / 2], known.back()}) {
    EXPECT_LT((hold_place[n] - first.place.front()).norm(), 1e-12);
    const auto exact = solve("wide.toml", place[n], displacement[n],
                             fmt::format("--hold {} {}", fmt::join(hold_place[n], " "),
                                         fmt::join(hold_displacement[n], " ")));
    const Eigen::Vector3d on_hand = vectorIn(exact.at("force")),
                          on_hold = vectorIn(exact.at("hold_force"));
    EXPECT_GT(on_hold.norm(), 0.1);
    EXPECT_LT((force[n] - on_hand).norm(), bound[n]) << n;
    EXPECT_LT((hold_force[n] - on_hold).norm(), hold_bound[n]) << n;
    EXPECT_LT(hold_bound[n], 0.2 * on_hold.norm()) << n;
  }
  EXPECT_EQ(press("cube.h5", 0.05, "none.h5", {"--hold", "first.h5"}), 2) << "not solved live";
  EXPECT_EQ(press("wide.toml", 0.05, "none.h5", {"--hold", "first.h5", "--rate", "500"}), 2);
  EXPECT_EQ(press("large.toml", 0.05, "none.h5", {"--hold", "first.h5"}), 2) << "another body";
}

TEST_F(LiveTest, AKeyLeavesASecondFingerAndLetsItGo) {
  const test::VirtualScreen screen;
  // In cube.toml, Enter would press at a corner of the area, whose other triangles are untouchable.
  Process run("palpate-viewer", {"view", "wide.toml", "--record", "key.h5"}, directory_->path());
  ASSERT_TRUE(test::says(run, "mouse at")) << run.output();
  test::Person person(screen.name(), "Palpate");
  for (const char* key : {"Return", "t", "t", "q"}) {
    person.press(key);
    std::this_thread::sleep_for(std::chrono::seconds(2));
  }
  ASSERT_EQ(run.wait(), 0) << run.output();
  hdf5::Reader in(*directory_ / "key.h5");
  in.findArrays();
  const auto touching = in.readList<std::uint8_t>("/contact/touching");
  const auto touched = in.readList<Eigen::Vector3d>("/contact/anchor"),
             held = in.readList<Eigen::Vector3d>("/hold/anchor");
  const auto begin = std::ranges::find_if(held, [](const auto& x) { return x.allFinite(); });
  ASSERT_NE(begin, held.end());
  const auto tick = static_cast<std::size_t>(begin - held.begin());
  EXPECT_EQ(held[tick], touched[tick - 1]);
  EXPECT_TRUE(touching[tick - 1] == 1 && touching[tick] == 0) << "the hand goes on elsewhere";
  EXPECT_TRUE(std::any_of(begin, held.end(), [](const auto& x) { return x.hasNaN(); }));
}

TEST_F(LiveTest, FinishedSitesReplaceTheGuessUnderTheHand) {
  Process run("palpate-viewer",
              {"view", "cube.toml", "--headless", "--hand-speed", "0.05", "--build", "grown.h5",
               "--duration", "20", "--record", "grown-run.h5"},
              directory_->path());
  ASSERT_EQ(run.wait(), 0) << run.output();
  const std::vector<bool> computed = computedAtContacts("grown-run.h5");
  ASSERT_GT(computed.size(), 1u);
  EXPECT_TRUE(computed.back()) << run.output();
  expectFollowed(touchesIn("grown-run.h5"));
}

TEST_F(LiveTest, ASceneIsBuiltWhileItIsTouched) {
  // The build has the lowest priority, so it may begin late.
  const auto touchedUntil = [](const std::function<bool(const Process&)>& enough) {
    Process run("palpate-viewer",
                {"view", "fine.toml", "--headless", "--hand-speed", "0.05", "--build", "beside.h5",
                 "--duration", "300"},
                directory_->path());
    EXPECT_TRUE(test::eventually([&] { return enough(run); })) << run.output();
    run.signal(SIGINT);
    EXPECT_EQ(run.wait(), 130) << run.output();
    return run.output();
  };
  const auto complete = HasSubstr("beside.h5 is complete");
  EXPECT_THAT(
      touchedUntil([](auto&) { return std::filesystem::exists(*directory_ / "beside.h5.state"); }),
      Not(complete));
  // Another command continues the build.
  for (const char* file : {"beside.h5", "whole.h5"}) {
    Process build("palpate-scheduler", {"build", "fine.toml", "-o", file}, directory_->path());
    EXPECT_EQ(build.wait(), 0) << build.output();
  }
  EXPECT_TRUE(contentOf(*directory_ / "beside.h5") == contentOf(*directory_ / "whole.h5"));
  // If the dataset is complete already, the client only says so.
  touchedUntil([&](const Process& run) { return testing::Value(run.output(), complete); });
}

TEST_F(LiveTest, AFollowerThatIsKilledIsStartedAgain) {
  auto run = view({"--live", "cube.toml", "--duration", "8", "--record", "killed.h5"});
  const auto follower = [&] {
    const auto found = test::runCommand("pgrep -P " + std::to_string(run->pid()));
    return found.exit_code == 0 ? std::stoi(found.output) : 0;
  };
  ASSERT_TRUE(test::eventually([&] { return follower() > 0; }));
  std::this_thread::sleep_for(std::chrono::seconds(3));
  const int killed = follower();
  ASSERT_EQ(kill(killed, SIGKILL), 0);
  EXPECT_TRUE(test::eventually([&] { return follower() > 0 && follower() != killed; }));
  ASSERT_EQ(run->wait(), 0) << run->output();
  expectFollowed(touchesIn("killed.h5"), "cube.toml", 5);
}

TEST_F(LiveTest, AFollowerMayBeAnotherProcess) {
  const std::string endpoint = "ipc://" + (*directory_ / "follower").string();
  Process follower("palpate-worker", {"follow", "--insecure", "--listen", endpoint},
                   directory_->path());
  auto run = view({"--live", "cube.toml", "--follower", endpoint, "--insecure", "--duration", "4",
                   "--record", "afar.h5"});
  ASSERT_EQ(run->wait(), 0) << run->output();
  expectFollowed(touchesIn("afar.h5"));
}

TEST_F(LiveTest, WithoutAFollowerTheDatasetIsFelt) {
  auto run =
      view({"--live", "cube.toml", "--follower", "ipc://" + (*directory_ / "nobody").string(),
            "--insecure", "--duration", "2", "--record", "alone.h5"});
  ASSERT_EQ(run->wait(), 0) << run->output();
  const Run felt = touchesIn("alone.h5");
  EXPECT_GT(felt.time.size(), 100u);
  EXPECT_EQ(std::ranges::count(felt.followed, 0), std::ssize(felt.followed));
}

TEST_F(LiveTest, TheSceneOfAnotherBuildIsRefused) {
  EXPECT_EQ(view({"--live", "stiff.toml", "--duration", "1"})->wait(), 2);
  EXPECT_EQ(view({"--live", "nothing.toml", "--duration", "1"})->wait(), 2);
  EXPECT_EQ(view({"--live", "cube.toml", "--fast", "--duration", "1"})->wait(), 2);
  EXPECT_EQ(view({"--follower", "ipc:///tmp/f", "--duration", "1"})->wait(), 2);
  EXPECT_EQ(view({"--build", "again.h5", "--duration", "1"})->wait(), 2);
  Process scene("palpate-viewer", {"view", "cube.toml", "--headless", "--fast", "--duration", "1"},
                directory_->path());
  EXPECT_EQ(scene.wait(), 2) << scene.output();
}

}  // namespace
}  // namespace palpate
