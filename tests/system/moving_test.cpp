#include <gmock/gmock.h>

#include "tests/system/small_build.hpp"

/// Moves a scheduler as described in docs/operating.md.
namespace palpate {
namespace {

using test::Process;
using testing::HasSubstr;

struct MovingTest : test::SmallBuild {
  MovingTest() : SmallBuild(5) {}

  std::unique_ptr<Process> serve(const std::string& state, const std::string& keys) {
    return SmallBuild::serve(state, "out.h5", {"--keys", keys});
  }
  /// Waits until the scheduler listens, because a copied directory still contains the address of
  /// the original.
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
  std::string keyOf(const std::string& folder) const {
    return told("key show --keys " + folder).substr(0, 64);
  }
  /// Admits the worker's key under the scheduler's new key.
  void introduce(const std::string& head) const {
    for (const std::string& folder : {head, std::string("node")})
      if (!exists(directory / folder)) told("key new --keys " + folder);
    told("key allow " + keyOf("node") + " worker node --keys " + head);
  }
  void copy(const std::string& from, const std::string& to) const {
    std::filesystem::copy(directory / from, directory / to,
                          std::filesystem::copy_options::recursive);
  }
  /// Loses the machine in the middle of a build, but not its disk.
  std::string losesItsMachine(const std::string& state) {
    introduce("head");
    told("key trust " + keyOf("head") + " --keys node");
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

TEST_F(MovingTest, AMovedBuildWithItsKeysGivesTheSameDataset) {
  const std::string before = losesItsMachine("state");
  copy("state", "moved");
  copy("head", "moved-head");
  auto scheduler = serve("moved", "moved-head");
  const std::string endpoint = endpointOf(*scheduler, "moved");
  EXPECT_NE(endpoint, before);
  EXPECT_THAT(scheduler->output(), HasSubstr("continuing from "));
  auto worker = work(endpoint, "60");
  expectFinished(*scheduler);
  EXPECT_EQ(worker->wait(), 0) << worker->output();
  EXPECT_TRUE(test::contentOf(directory / "out.h5") == undisturbed());
}

TEST_F(MovingTest, WithOtherKeysWorkersExplainTheRemedyAndWait) {
  losesItsMachine("state");
  copy("state", "moved");
  introduce("other-head");
  auto scheduler = serve("moved", "other-head");
  auto worker = work(endpointOf(*scheduler, "moved"), "600");
  EXPECT_TRUE(test::says(*worker, "palpate key trust")) << worker->output();
  told("key trust " + keyOf("other-head") + " --keys node");
  expectFinished(*scheduler);
  EXPECT_EQ(worker->wait(), 0) << worker->output();
  EXPECT_TRUE(test::contentOf(directory / "out.h5") == undisturbed());
}

}  // namespace
}  // namespace palpate
