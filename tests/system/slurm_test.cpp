#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "tests/support/long_tests.hpp"
#include "tests/system/own_network.hpp"
#include "tests/system/small_build.hpp"

/// A real Slurm (Debian's slurm-wlm) with two nodes, one of them behind a cable that can be pulled.
namespace palpate {
namespace {

using testing::HasSubstr;

struct SlurmTest : test::SmallBuild {
  SlurmTest() : SmallBuild(11) {}
  test::OwnNetwork network;
  test::TemporaryDirectory cluster;
  std::unique_ptr<test::Process> munged, slurmctld, node_here, node_there;

  void SetUp() override {
    if (!test::longTestsAreWanted())
      GTEST_SKIP() << "a build by a real Slurm takes minutes and was NOT tested; set "
                      "PALPATE_LONG_TESTS=1 (deploy/test --all does)";
    if (geteuid() != 0 || test::runCommand("command -v slurmctld munged").exit_code != 0)
      GTEST_SKIP() << "no root, or no Slurm (slurm-wlm, munge): fleets were NOT tested on one";
    ASSERT_TRUE(network.joinAnother());
    configure();
    startCluster();
  }
  void TearDown() override {
    unsetenv("SLURM_CONF");
    // Whatever a failed test left: their daemons go with this object, their jobs do not.
    test::runCommand("pkill -KILL -f " + (directory / "keys").string());
  }

  void configure() const {
    namespace fs = std::filesystem;
    for (const char* folder : {"munge", "state", "spool", "log"})
      fs::create_directories(cluster / folder);
    fs::permissions(cluster.path(), fs::perms::owner_all | fs::perms::others_exec |
                                        fs::perms::others_read | fs::perms::group_exec);
    fs::permissions(cluster / "munge",
                    fs::perms::owner_all | fs::perms::group_exec | fs::perms::others_exec);
    std::ofstream(cluster / "munge/munge.key") << std::string(128, 'k');
    fs::permissions(cluster / "munge/munge.key", fs::perms::owner_read);
    char host[256] = {};
    gethostname(host, sizeof host - 1);
    const std::string t = cluster.path().string();
    std::ofstream(cluster / "slurm.conf")
        << "ClusterName=palpate\nSlurmctldHost=" << host << "(10.77.0.1)\n"
        << "SlurmUser=root\nSlurmdUser=root\nAuthType=auth/munge\nCryptoType=crypto/munge\n"
        << "AuthInfo=socket=" << t << "/munge/munge.sock,cred_expire=5\nMpiDefault=none\n"
        << "ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nReturnToService=2\n"
        << "SlurmctldPidFile=" << t << "/slurmctld.pid\nSlurmdPidFile=" << t << "/slurmd.%n.pid\n"
        << "StateSaveLocation=" << t << "/state\nSlurmdSpoolDir=" << t << "/spool/%n\n"
        << "SlurmctldLogFile=" << t << "/log/ctld.log\nSlurmdLogFile=" << t << "/log/d.%n.log\n"
        << "SwitchType=switch/none\nJobAcctGatherType=jobacct_gather/none\n"
        << "AccountingStorageType=accounting_storage/none\nJobCompType=jobcomp/none\n"
        << "SelectType=select/cons_tres\nSelectTypeParameters=CR_Core\n"
        << "SchedulerType=sched/backfill\n"
        << "SchedulerParameters=sched_interval=1,bf_interval=1,sched_min_interval=0\n"
        << "KillWait=5\nMinJobAge=30\nSlurmdTimeout=10\nSlurmdParameters=config_overrides\n"
        << "NodeName=here NodeHostname=" << host << " NodeAddr=10.77.0.1 Port=6821 CPUs=2\n"
        << "NodeName=there NodeHostname=" << host << " NodeAddr=10.77.0.2 Port=6822 CPUs=2\n"
        << "PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP\n";
    setenv("SLURM_CONF", (cluster / "slurm.conf").c_str(), 1);
  }

  std::unique_ptr<test::Process> daemon(const char* program, std::vector<std::string> arguments) {
    return std::make_unique<test::Process>(program, std::move(arguments), cluster.path());
  }
  std::unique_ptr<test::Process> node(const char* name) {
    return daemon("/usr/sbin/slurmd", {"-D", "-N", name});
  }
  void startCluster() {
    const std::string munge = (cluster / "munge").string();
    munged = daemon("/usr/sbin/munged",
                    {"-F", "--force", "--key-file=" + munge + "/munge.key",
                     "--socket=" + munge + "/munge.sock", "--pid-file=" + munge + "/munged.pid",
                     "--log-file=" + munge + "/munged.log", "--seed-file=" + munge + "/seed"});
    ASSERT_TRUE(test::eventually([&] { return exists(cluster / "munge/munge.sock"); }));
    slurmctld = daemon("/usr/sbin/slurmctld", {"-D", "-c"});
    node_here = node("here");
    network.goThere();
    node_there = node("there");
    network.goHere();
    ASSERT_TRUE(test::eventually([] { return idleNodes() == 2; })) << slurmctld->output();
  }
  static int idleNodes() {
    return std::atoi(test::runCommand("sinfo -h -t idle -o %D").output.c_str());
  }
  static std::string jobs() { return test::runCommand("squeue -h --array -o '%T %N'").output; }
};

TEST_F(SlurmTest, ABuildComesToItsEndThoughANodeIsCutOffAndTheTimeOfJobsIsUp) {
  auto serve = start("palpate-scheduler", {"serve", "cube.toml", "--listen", "tcp://10.77.0.1:*",
                                           "--state", "state", "-o", "out.h5"});
  const std::string endpoint = endpointIn("state");
  auto fleet =
      start("palpate-scheduler", {"fleet", "slurm", "state", "--connect", endpoint, "--keys",
                                  (directory / "keys").string(), "--most", "4", "--minutes", "1",
                                  "--every", "1", "--log", (directory / "job-%A-%a.log").string()});
  ASSERT_TRUE(test::eventually([] { return jobs().find("RUNNING there") != std::string::npos; }))
      << fleet->output() << jobs();
  const auto begun = std::chrono::steady_clock::now();
  ASSERT_TRUE(journalGrows(*serve, "state", 20000)) << serve->output();
  ASSERT_EQ(test::runCommand("ip link set here down").exit_code, 0);
  ASSERT_TRUE(journalGrows(*serve, "state", 20000)) << "the other node works on";
  ASSERT_EQ(test::runCommand("ip link set here up").exit_code, 0);

  // However fast this machine is, the time of the jobs is up while they solve.
  ASSERT_EQ(start("palpate-scheduler", {"pause", "state"})->wait(), 0);
  std::this_thread::sleep_until(begun + std::chrono::seconds(35));
  ASSERT_EQ(start("palpate-scheduler", {"resume", "state"})->wait(), 0);
  const auto isUp = [&] { return serve->output().find("left: interrupted") != std::string::npos; };
  ASSERT_TRUE(test::eventually([&] { return !serve->running() || isUp(); })) << serve->output();
  EXPECT_TRUE(serve->running()) << "the build was over before: give it more to do";

  expectFinished(*serve);
  EXPECT_EQ(fleet->wait(), 0) << fleet->output();
  EXPECT_THAT(fleet->output(), HasSubstr("no job of palpate-"));
  EXPECT_TRUE(test::eventually([&] { return jobs().empty(); })) << jobs();
  EXPECT_EQ(test::contentOf(directory / "out.h5"), undisturbed());
}

}  // namespace
}  // namespace palpate
