#include "viewer/live/live_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <thread>

#include "common/base/child_process.hpp"
#include "common/problem/problem.hpp"
#include "tests/support/problems.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

constexpr double radius = 0.06;  // m
const std::string worker = PALPATE_BIN_DIR "/palpate-worker";

/// A hand on a body, and a live solver.
class LiveLinkTest : public ::testing::Test {
 protected:
  /// Writes a program that stands for the live solver.
  std::string program(const std::string& commands) {
    const std::filesystem::path file = directory_ / "program";
    std::ofstream(file) << "#!/bin/sh\n" << commands << '\n';
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    return file.string();
  }
  LiveLinkOptions options(const std::string& program = worker) const {
    return {encodeProblem(problem_), "", {}, program};
  }

  /// Lets the hand press, slightly deeper in each tick, until `condition` is true.
  bool pressUntil(const std::function<bool()>& condition) {
    const Eigen::Vector3d place = problem_.active[0].finger->center;
    const auto limit = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (!condition() && std::chrono::steady_clock::now() < limit) {
      hand_time_ += 0.005;
      touch_.publish({hand_time_, true, place, {-1e-3 - 1e-5 * hand_time_, 0, 0}, {}});
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return condition();
  }

  test::TemporaryDirectory directory_;
  Problem problem_ = test::fingeredBlob(radius);
  LiveTouch touch_{radius};
  double hand_time_ = 0;  ///< s
};

TEST_F(LiveLinkTest, SaysHowTheLiveSolverEnded) {
  LiveLink link(touch_, options(program("exit 7")));
  EXPECT_FALSE(link.waitUntilReady(std::chrono::minutes(1)));
  EXPECT_THAT(link.trouble(), testing::HasSubstr("7"));
}

TEST_F(LiveLinkTest, TellsWhyASecondFingerCannotHoldAndGoesOn) {
  LiveLink link(touch_, options());
  ASSERT_TRUE(link.waitUntilReady(std::chrono::minutes(1))) << link.trouble();
  const auto isTroubled = [&] { return !link.trouble().empty(); };
  const auto isWell = [&] { return link.trouble().empty(); };
  const Eigen::Vector3d hand = problem_.active[0].finger->center,
                        fixed = problem_.mesh.nodes[problem_.fixed.front()], push(0, -0.005, 0);
  const Hold holds[] = {{fixed, push}, {hand, push}, {{9, 9, 9}, push}, {{0, 0.1, 0}, {0, -1, 0}}};
  for (const Hold& hold : holds) {
    touch_.setHold(hold);
    EXPECT_TRUE(pressUntil(isTroubled)) << hold.place << '\n' << hold.displacement;
    touch_.setHold(std::nullopt);
    EXPECT_TRUE(pressUntil(isWell)) << link.trouble();
  }
  EXPECT_GT(link.statistics().answers, 0u);
  EXPECT_EQ(link.statistics().restarts, 0u) << "the connection stays";
}

TEST_F(LiveLinkTest, SaysThatALiveSolverElsewhereNeedsItsKeyAndAnAdmission) {
  const KeyFolder here(directory_ / "here"), there(directory_ / "there");
  const PublicKey server = there.ownOrNew().open(), client = here.ownOrNew().open();
  const std::string endpoint = "ipc://" + (directory_ / "socket").string();
  const ChildProcess solver(
      {worker, "follow", "--quiet", "--listen", endpoint, "--keys", there.path().string()});
  const LiveLinkOptions options = {encodeProblem(problem_), endpoint, here};
  const auto trouble = [&] {
    LiveLink link(touch_, options);
    link.waitUntilReady(std::chrono::minutes(1));
    return link.trouble();
  };
  EXPECT_THAT(trouble(), testing::HasSubstr("palpate key trust"));
  here.trust(server, "*");
  EXPECT_THAT(trouble(), testing::HasSubstr("palpate key allow"));
  there.allow({client, Roles::system_operator, ""});
  {
    LiveLink link(touch_, options);  // the live solver reads its keys from time to time
    EXPECT_TRUE(pressUntil([&] { return link.statistics().answers > 0; })) << link.trouble();
  }
  EXPECT_EQ(trouble(), "") << "the client before has left";
}

}  // namespace
}  // namespace palpate
