#include <gmock/gmock.h>

#include "tests/support/command.hpp"
#include "tests/system/small_build.hpp"

/// Keys as people use them: palpate key, serve, work, status, stop; each user has a folder.
namespace palpate {
namespace {

using test::Process;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

struct KeysTest : test::SmallBuild {
  /// A command of `user`, in the test's folder.
  test::CommandResult run(const std::string& user, const std::string& command) const {
    return test::runCommand("cd '" + directory.path().string() + "' && PALPATE_KEYS='" +
                            (directory / user).string() + "' " + PALPATE_BIN_DIR "/palpate " +
                            command);
  }
  void expectDone(const std::string& user, const std::string& command) const {
    const auto result = run(user, command);
    EXPECT_EQ(result.exit_code, 0) << command << ": " << result.output;
  }
  std::string keyOf(const std::string& user) const {
    return run(user, "key show").output.substr(0, 64);
  }
  void serve(const std::vector<std::string>& more) {
    scheduler = SmallBuild::serve("state", "out.h5", more);
    endpoint = endpointIn("state");
  }
  std::unique_ptr<Process> workAs(const std::string& user) {
    return start("palpate-worker", {"work", "--alone", "--connect", endpoint, "--keys", user});
  }

  std::unique_ptr<Process> scheduler;
  std::string endpoint;
};

TEST_F(KeysTest, AnotherUserGetsInOnlyAfterBothKnowEachOthersKeys) {
  serve({"--keys", "head"});
  expectDone("node", "key new");
  EXPECT_THAT(run("node", "status " + endpoint).output, HasSubstr("palpate key trust"));
  expectDone("node", "key trust " + keyOf("head"));
  EXPECT_THAT(run("node", "status " + endpoint).output, HasSubstr("palpate key allow"));
  expectDone("head", "key allow " + keyOf("node") + " worker 'node one'");
  EXPECT_TRUE(test::eventually([&] {
    return run("node", "status " + endpoint).output.find("needs observer") != std::string::npos;
  }));
  EXPECT_THAT(run("node", "stop " + endpoint).output, HasSubstr("needs operator"));
  auto worker = workAs("node");
  EXPECT_EQ(worker->wait(), 0) << worker->output();
  expectFinished(*scheduler);
  EXPECT_TRUE(test::contentOf(directory / "out.h5") == undisturbed());
}

TEST_F(KeysTest, AWorkerWaitsForAdmissionAndLeavesOnWithdrawal) {
  serve({"--keys", "head"});
  expectDone("node", "key new");
  expectDone("node", "key trust " + keyOf("head"));
  auto worker = workAs("node");
  EXPECT_TRUE(test::says(*worker, "does not admit this key"));
  expectDone("head", "key allow " + keyOf("node") + " worker node");
  EXPECT_TRUE(test::eventually([&] {
    return scheduler->output().find("joined") != std::string::npos || !worker->running();
  }));
  if (scheduler->running()) expectDone("head", "key withdraw node");
  // The build may have completed before.
  EXPECT_THAT(worker->wait(), testing::AnyOf(0, 1)) << worker->output();
  EXPECT_THAT(worker->output(),
              testing::AnyOf(HasSubstr("no longer allowed"), HasSubstr("no more work")));
}

TEST_F(KeysTest, ABuildHasItsOwnKeysInItsStateDirectory) {
  // Pause the build before its start, so that it is not complete before the queries.
  auto first = SmallBuild::serve("out.h5.state", "out.h5");
  endpointIn("out.h5.state");
  expectDone("anybody", "pause out.h5.state");
  EXPECT_EQ(first->stop(SIGTERM), 130);
  std::filesystem::remove(directory / "out.h5.state" / "endpoint");
  auto build = startBuild("out.h5", "2");
  EXPECT_THAT(run("anybody", "status " + endpointIn("out.h5.state")).output,
              AllOf(HasSubstr("its key differs"), Not(HasSubstr("scene"))));
  EXPECT_THAT(run("anybody", "status out.h5.state").output, HasSubstr("scene cube"));
  expectDone("anybody", "resume out.h5.state");
  expectFinished(*build);
}

TEST_F(KeysTest, ABuildNeedsNoHome) {
  const auto result = test::runCommand("cd '" + directory.path().string() +
                                       "' && env -u HOME -u PALPATE_KEYS " PALPATE_BIN_DIR
                                       "/palpate build cube.toml -o out.h5 -j 1");
  EXPECT_THAT(result.exit_code, testing::AnyOf(0, 3)) << result.output;
}

TEST_F(KeysTest, AdmittingEverybodyNeedsAnExplicitOption) {
  serve({"--insecure"});
  EXPECT_THAT(run("anybody", "status " + endpoint + " --insecure").output, HasSubstr("scene cube"));
  EXPECT_THAT(run("anybody", "status state").output, HasSubstr("scene cube"));
  EXPECT_THAT(run("anybody", "status " + endpoint).output, HasSubstr("--insecure"));
  auto worker = start("palpate-worker", {"work", "-j", "2", "--connect", endpoint, "--insecure"});
  EXPECT_EQ(worker->wait(), 0) << worker->output();
  expectFinished(*scheduler);
}

TEST_F(KeysTest, KeysThatOthersMayReadAreRefused) {
  expectDone("head", "key new");
  test::runCommand("chmod 755 '" + (directory / "head").string() + "'");
  auto refused = SmallBuild::serve("state", "out.h5", {"--keys", "head"});
  EXPECT_EQ(refused->wait(), 2);
  EXPECT_THAT(refused->output(), ContainsRegex("chmod 0700.*head"));
}

}  // namespace
}  // namespace palpate
