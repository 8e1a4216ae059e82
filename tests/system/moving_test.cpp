#include <gmock/gmock.h>

#include "tests/support/command.hpp"
#include "tests/system/small_build.hpp"

/// A scheduler that goes on somewhere else, as docs/operating.md says.
namespace palpate {
namespace {

using test::Process;
using testing::HasSubstr;

struct MovingTest : test::SmallBuild {
  MovingTest() : SmallBuild(5) {}

  std::unique_ptr<Process> serve(const std::string& state, const std::string& keys) {
    return start("palpate-scheduler", {"serve", "cube.toml", "--listen", "tcp://127.0.0.1:*",
                                       "--state", state, "-o", "out.h5", "--keys", keys});
  }
  /// A copy says at first where the original listened.
  std::string endpointOf(Process& scheduler, const std::string& state) const {
    EXPECT_TRUE(test::eventually([&] {
      return !scheduler.running() || scheduler.output().find("listening on") != std::string::npos;
    })) << scheduler.output();
    return endpointIn(state);
  }
  std::unique_ptr<Process> work(const std::string& endpoint, const std::string& give_up) {
    return start("palpate-worker", {"work", "-j", "2", "--connect", endpoint, "--keys", "node",
                                    "--give-up", give_up});
  }
  test::CommandResult palpate(const std::string& arguments) const {
    return test::runCommand("cd '" + directory.path().string() +
                            "' && " PALPATE_BIN_DIR "/palpate " + arguments);
  }
  std::string keyOf(const std::string& folder) const {
    return palpate("key show --keys " + folder).output.substr(0, 64);
  }
  /// The worker's key is let in by the new key of a scheduler.
  void introduce(const std::string& head) const {
    for (const std::string& folder : {head, std::string("node")}) {
      if (exists(directory / folder)) continue;
      EXPECT_EQ(palpate("key new --keys " + folder).exit_code, 0);
    }
    EXPECT_EQ(palpate("key allow " + keyOf("node") + " worker node --keys " + head).exit_code, 0);
  }
  void copy(const std::string& from, const std::string& to) const {
    std::filesystem::copy(directory / from, directory / to,
                          std::filesystem::copy_options::recursive);
  }
  /// A machine that is gone in the middle of a build, and whose disk is not.
  std::string losesItsMachine(const std::string& state) {
    introduce("head");
    EXPECT_EQ(palpate("key trust " + keyOf("head") + " --keys node").exit_code, 0);
    auto scheduler = serve(state, "head");
    const std::string endpoint = endpointIn(state);
    auto worker = work(endpoint, "5");
    EXPECT_TRUE(journalGrows(*scheduler, state, 20000)) << scheduler->output();
    scheduler->stop(SIGKILL);
    EXPECT_EQ(worker->wait(), 1);
    EXPECT_THAT(worker->output(), HasSubstr("is this its address?"));
    return endpoint;
  }
};

TEST_F(MovingTest, GoesOnElsewhereWithItsKeysToTheSameDataset) {
  const std::string before = losesItsMachine("state");
  copy("state", "moved");
  copy("head", "moved-head");
  auto scheduler = serve("moved", "moved-head");
  const std::string endpoint = endpointOf(*scheduler, "moved");
  EXPECT_NE(endpoint, before);
  EXPECT_THAT(scheduler->output(), HasSubstr("going on:"));
  auto worker = work(endpoint, "60");
  expectFinished(*scheduler);
  EXPECT_EQ(worker->wait(), 0) << worker->output();
  EXPECT_TRUE(test::contentOf(directory / "out.h5") == undisturbed());
}

TEST_F(MovingTest, WithOtherKeysWorkersSayWhatIsToBeDoneAndWaitForIt) {
  losesItsMachine("state");
  copy("state", "moved");
  introduce("other-head");
  auto scheduler = serve("moved", "other-head");
  auto worker = work(endpointOf(*scheduler, "moved"), "600");
  EXPECT_TRUE(test::eventually([&] {
    return worker->output().find("palpate key trust takes it") != std::string::npos;
  })) << worker->output();
  EXPECT_EQ(palpate("key trust " + keyOf("other-head") + " --keys node").exit_code, 0);
  expectFinished(*scheduler);
  EXPECT_EQ(worker->wait(), 0) << worker->output();
  EXPECT_TRUE(test::contentOf(directory / "out.h5") == undisturbed());
}

}  // namespace
}  // namespace palpate
