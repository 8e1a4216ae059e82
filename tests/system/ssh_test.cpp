#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/system/own_network.hpp"
#include "tests/system/small_build.hpp"

/// Workstations, simulated on one machine: a real sshd in a network of this test.
namespace palpate {
namespace {

using testing::HasSubstr;

struct SshTest : test::SmallBuild {
  SshTest() : SmallBuild(6) {}
  test::OwnNetwork network;
  std::unique_ptr<test::Process> sshd;

  void SetUp() override {
    if (geteuid() != 0 || test::runCommand("command -v sshd ssh ssh-keygen").exit_code != 0)
      GTEST_SKIP() << "no root, or no sshd (openssh-server): fleets were NOT tested by ssh";
    makeKey("host");
    makeKey("user");
    std::ofstream(path("known")) << "[127.0.0.1]:2222 " << test::contentOf(path("host.pub"));
    std::ofstream(path("sshd_config"))
        << "Port 2222\nListenAddress 127.0.0.1\nHostKey " << path("host") << "\nAuthorizedKeysFile "
        << path("user.pub") << "\nPidFile none\nStrictModes no\nPermitRootLogin prohibit-password\n"
        << "SetEnv PALPATE_KEYS=" << path("keys") << '\n';
    std::filesystem::create_directories("/run/sshd");
    sshd = std::make_unique<test::Process>(
        "/usr/sbin/sshd", std::vector<std::string>{"-D", "-e", "-f", path("sshd_config")},
        directory.path());
    ASSERT_TRUE(test::says(*sshd, "Server listening")) << sshd->output();
  }
  std::string path(const char* name) const { return (directory / name).string(); }
  void makeKey(const char* name) const {
    ASSERT_EQ(test::runCommand("ssh-keygen -q -t ed25519 -N '' -f '" + path(name) + "'").exit_code,
              0);
  }
  /// Returns once the scheduler listens.
  std::unique_ptr<test::Process> startServe() {
    auto scheduler = serve("state", "out.h5");
    endpointIn("state");
    return scheduler;
  }
  std::unique_ptr<test::Process> startFleet(const std::string& known,
                                            const std::string& program = PALPATE_BIN_DIR
                                            "/palpate") {
    return start("palpate-scheduler", {"fleet", "ssh", "state", "--hosts", "127.0.0.1:2",
                                       "--program", program, "--every", "1", "--", "-p", "2222",
                                       "-i", path("user"), "-o", "UserKnownHostsFile=" + known});
  }
};

TEST_F(SshTest, WorkersRestartAfterABrokenConnectionAndNoneIsLeft) {
  auto scheduler = startServe();
  auto fleet = startFleet(path("known"));
  ASSERT_TRUE(journalGrows(*scheduler, "state", 10000)) << fleet->output();
  for (const pid_t connection : fleet->children()) kill(connection, SIGKILL);
  EXPECT_TRUE(test::eventually([&] { return workers().empty(); }))
      << "they end with the connection";
  ASSERT_TRUE(test::eventually([&] { return !workers().empty(); })) << fleet->output();
  expectFinished(*scheduler);
  EXPECT_EQ(fleet->wait(), 0) << fleet->output();
  EXPECT_THAT(fleet->output(),
              testing::AllOf(HasSubstr("127.0.0.1:2: ssh ended with signal 9 (Killed)"),
                             HasSubstr("no worker is left on 1 machine\n")));
  EXPECT_TRUE(workers().empty());
}

TEST_F(SshTest, AnInterruptedFleetLeavesNoWorkerAndTheBuildWaits) {
  auto scheduler = startServe();
  auto fleet = startFleet(path("known"));
  ASSERT_TRUE(journalGrows(*scheduler, "state", 10000)) << fleet->output();
  EXPECT_EQ(fleet->stop(SIGTERM), 130) << fleet->output();
  EXPECT_TRUE(test::eventually([&] { return workers().empty(); }));
  EXPECT_TRUE(scheduler->running());
}

TEST_F(SshTest, AnUnknownMachineIsNotTrustedAndTriedAgain) {
  auto scheduler = startServe();
  auto fleet = startFleet(path("nobody"));
  EXPECT_TRUE(test::says(
      *fleet, "exit code 255 (ssh cannot connect; see its messages above); trying again in 5 s"))
      << fleet->output();
  EXPECT_THAT(fleet->output(), HasSubstr("Host key verification failed"));
  EXPECT_EQ(fleet->stop(SIGTERM), 130);
}

TEST_F(SshTest, AMachineWithoutTheProgramIsTriedAgainUntilInstalled) {
  auto scheduler = startServe();
  auto fleet = startFleet(path("known"), path("worker"));
  EXPECT_TRUE(test::says(
      *fleet, "exit code 127 (palpate (option --program) or one of its libraries is missing"))
      << fleet->output();
  std::filesystem::create_symlink(PALPATE_BIN_DIR "/palpate", path("worker"));
  expectFinished(*scheduler);
  EXPECT_EQ(fleet->wait(), 0) << fleet->output();
  EXPECT_TRUE(workers().empty());
}

TEST(SshCommand, NamesAnInvalidMachine) {
  const std::string program = PALPATE_BIN_DIR "/palpate-scheduler";
  for (const char* host : {"node:0", "node:many", "-oProxyCommand=x", ":4"}) {
    const auto result =
        test::runCommand(program + " fleet ssh tcp://127.0.0.1:9 --dry-run --hosts=" + host);
    EXPECT_EQ(result.exit_code, 2) << result.output;
    EXPECT_THAT(result.output, testing::ContainsRegex("number of workers|is not a machine"));
  }
}

}  // namespace
}  // namespace palpate
