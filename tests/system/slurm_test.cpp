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
  explicit SlurmTest(int cells = 11) : SmallBuild(cells) {}
  test::OwnNetwork network;
  test::TemporaryDirectory cluster;
  std::unique_ptr<test::Process> munged, slurmctld, node_here, node_there;

  void SetUp() override {
    if (!test::longTestsAreWanted())
      GTEST_SKIP() << "a build by a real Slurm takes minutes and was NOT tested; set "
                      "PALPATE_LONG_TESTS=1 (deploy/test --nightly does)";
    if (geteuid() != 0 || test::runCommand("command -v slurmctld munged").exit_code != 0)
      GTEST_SKIP() << "no root, or no Slurm (slurm-wlm, munge): fleets were NOT tested on one";
    ASSERT_TRUE(network.joinAnother());
    configure();
    startCluster();
  }
  void TearDown() override {
    unsetenv("SLURM_CONF");
    // Cleans up after a failed test: the daemons end with this object, but their jobs do not.
    for (const pid_t worker : workers()) kill(worker, SIGKILL);
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
        << "KillWait=5\nMinJobAge=300\nSlurmdTimeout=10\nSlurmdParameters=config_overrides\n"
        << "MaxArraySize=4\nEnforcePartLimits=ALL\n"
        << "NodeName=here NodeHostname=" << host << " NodeAddr=10.77.0.1 Port=6821 CPUs=2\n"
        << "NodeName=there NodeHostname=" << host << " NodeAddr=10.77.0.2 Port=6822 CPUs=2\n"
        << "PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP\n"
        << "PartitionName=short Nodes=ALL MaxTime=5 State=UP\n";
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
    slurmctld = daemon("/usr/sbin/slurmctld", {"-D"});
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
  static int jobsThatWere() {
    return std::atoi(test::runCommand("squeue -h --array -t all | wc -l").output.c_str());
  }
  std::unique_ptr<test::Process> serve(const std::string& address = "10.77.0.1") {
    return SmallBuild::serve("state", "out.h5", {}, "tcp://" + address + ":*");
  }
  /// Runs `palpate fleet` with the given program; workers lie in its folder.
  std::unique_ptr<test::Process> fleet(std::vector<std::string> more,
                                       const std::string& program = "palpate-scheduler") {
    std::vector<std::string> words = {"fleet",
                                      "slurm",
                                      "state",
                                      "--keys",
                                      (directory / "keys").string(),
                                      "--every",
                                      "1",
                                      "--log",
                                      (directory / "job-%A-%a.log").string()};
    words.insert(words.end(), more.begin(), more.end());
    return start(program, words);
  }
  static void writeProgram(const std::filesystem::path& file, const std::string& content) {
    std::ofstream(file, std::ios::binary) << content;
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }
  /// The worker, linked with a missing library.
  static void writeBrokenWorker(const std::filesystem::path& file) {
    std::string bytes = test::contentOf(PALPATE_BIN_DIR "/palpate-worker");
    const std::string library = "libzmq.so.5";
    ASSERT_NE(bytes.find(library), std::string::npos);
    writeProgram(file, bytes.replace(bytes.find(library), library.size(), "libzmq.so.9"));
  }
  /// Palpate as installed for the nodes, without its workers. Returns the scheduler's path.
  std::string installElsewhere() const {
    const std::filesystem::path program = directory / "bin" / "palpate-scheduler";
    std::filesystem::create_directory(directory / "bin");
    for (const char* each : {"palpate", "palpate-scheduler"})
      std::filesystem::copy_file(PALPATE_BIN_DIR "/" + std::string(each), directory / "bin" / each);
    return program.string();
  }
};

/// Tests of faults that do not depend on the scene, so the build is small.
struct SlurmFaultsTest : SlurmTest {
  SlurmFaultsTest() : SlurmTest(6) {}

  /// A scheduler that could use eight workers.
  std::unique_ptr<test::Process> serveWide(const std::string& address = "10.77.0.1") {
    auto scheduler = serve(address);
    const std::string endpoint = endpointIn("state");
    auto worker =
        start("palpate-worker",
              {"work", "--connect", "tcp://10.77.0.1" + endpoint.substr(endpoint.rfind(':'))});
    EXPECT_TRUE(test::eventually([&] { return ready() >= 20; })) << worker->output();
    EXPECT_EQ(worker->stop(SIGTERM), 130) << worker->output();
    return scheduler;
  }
  int ready() const {
    const std::string status =
        test::runCommand(PALPATE_BIN_DIR "/palpate status --json " + (directory / "state").string())
            .output;
    const std::string field = "\"ready\":";
    const auto at = status.find(field);
    return at == std::string::npos ? 0 : std::atoi(status.c_str() + at + field.size());
  }
};

TEST_F(SlurmTest, ABuildEndsDespiteALostNodeAndExpiredJobs) {
  auto scheduler = serve();
  auto all = fleet({"--connect", endpointIn("state"), "--most", "4", "--minutes", "1"});
  ASSERT_TRUE(test::eventually([] { return jobs().find("RUNNING there") != std::string::npos; }))
      << all->output() << jobs();
  const auto begun = std::chrono::steady_clock::now();
  ASSERT_TRUE(journalGrows(*scheduler, "state", 20000)) << scheduler->output();
  ASSERT_EQ(test::runCommand("ip link set here down").exit_code, 0);
  ASSERT_TRUE(journalGrows(*scheduler, "state", 20000)) << "the other node works on";
  ASSERT_EQ(test::runCommand("ip link set here up").exit_code, 0);

  // Pause the build, so that the time limit of the jobs ends during the build on any machine.
  told("pause state");
  std::this_thread::sleep_until(begun + std::chrono::seconds(35));
  told("resume state");
  const auto isUp = [&] {
    return scheduler->output().find("left: interrupted") != std::string::npos;
  };
  ASSERT_TRUE(test::eventually([&] { return !scheduler->running() || isUp(); }))
      << scheduler->output();
  EXPECT_TRUE(scheduler->running()) << "the build ended too early: make it larger";

  expectFinished(*scheduler);
  EXPECT_EQ(all->wait(), 0) << all->output();
  EXPECT_THAT(all->output(), HasSubstr("no job of palpate-"));
  EXPECT_TRUE(test::eventually([&] { return jobs().empty(); })) << jobs();
  EXPECT_EQ(test::contentOf(directory / "out.h5"), undisturbed());
}

TEST_F(SlurmFaultsTest, ARefusedOptionEndsTheFleetWithSlurmsMessage) {
  auto scheduler = serve();
  endpointIn("state");
  struct Case {
    std::vector<std::string> options;
    const char* said;
  };
  for (const Case& wrong : {
           Case{{"--", "--partition=nosuch"}, "Invalid partition name"},
           Case{{"--minutes", "100", "--", "--partition=short"}, "time limit is invalid"},
           Case{{"--constraint", "nosuch"}, "Invalid feature"},
           Case{{"--", "--nosuch"}, "unrecognized option"},
       }) {
    auto refused = fleet(wrong.options);
    EXPECT_EQ(refused->wait(), 2);
    EXPECT_THAT(refused->output(), HasSubstr(wrong.said));
  }
  EXPECT_EQ(jobs(), "");
}

TEST_F(SlurmFaultsTest, HeldJobsAreNamedAndNoneIsLeftAfterKills) {
  ASSERT_EQ(test::runCommand("ip addr add 10.77.0.3/24 dev here").exit_code, 0);
  auto scheduler = serveWide("0.0.0.0");
  const std::string endpoint = endpointIn("state");
  const std::string port = endpoint.substr(endpoint.rfind(':'));
  const auto held = [&](const std::string& address) {
    return fleet({"--connect", "tcp://" + address + port, "--most", "8", "--backlog", "8",
                  "--leave-idle", "5", "--", "--hold"});
  };
  const auto eightAreHeld = [] {
    const std::string all = jobs();
    return std::ranges::count(all, '\n') == 8 && all.find("RUNNING") == std::string::npos;
  };
  auto first = held("10.77.0.1");
  EXPECT_TRUE(test::says(*first, "8 queued (8 JobHeldUser)")) << first->output();
  EXPECT_TRUE(eightAreHeld()) << "in arrays of at most three, the limit of this Slurm";
  first->stop(SIGKILL);

  // For a fleet, the address to which the scheduler moved.
  auto second = held("10.77.0.3");
  EXPECT_TRUE(test::says(*second, "8 jobs connect to another endpoint")) << second->output();
  EXPECT_TRUE(test::says(*second, "8 queued (8 JobHeldUser)")) << second->output();
  EXPECT_TRUE(eightAreHeld()) << jobs();
  EXPECT_LE(jobsThatWere(), 16) << "no jobs are added to the held ones";
  second->stop(SIGKILL);

  // The rest is computed without the fleet, while the Slurm controller is down.
  slurmctld->stop(SIGKILL);
  auto worker = start("palpate-worker", {"work", "-j", "2", "--connect", "tcp://127.0.0.1" + port});
  expectFinished(*scheduler);
  EXPECT_EQ(worker->wait(), 0) << worker->output();
  auto third = held("10.77.0.3");
  EXPECT_TRUE(test::says(*third, "cancelling again")) << third->output();
  slurmctld = daemon("/usr/sbin/slurmctld", {"-D"});
  EXPECT_EQ(third->wait(), 0) << third->output();
  EXPECT_THAT(third->output(), HasSubstr("the build is complete: no job of palpate-"));
  EXPECT_EQ(jobs(), "");
}

TEST_F(SlurmFaultsTest, JobsThatDieAtOnceAreTriedOneByOneUntilOneLives) {
  const std::string program = installElsewhere();
  const std::filesystem::path worker = directory / "bin" / "palpate-worker";
  writeBrokenWorker(worker);
  auto scheduler = serveWide();
  auto all = fleet({"--connect", endpointIn("state"), "--most", "8", "--backlog", "8"}, program);
  EXPECT_TRUE(test::says(*all, "The next job is submitted alone, in 4 s")) << all->output();
  EXPECT_THAT(all->output(), testing::AllOf(HasSubstr("(exit code 127)"), HasSubstr("_1 on "),
                                            HasSubstr("ends with: "),
                                            HasSubstr("cannot open shared object file")));
  // There are at most eight jobs, four replacements for failed ones, and one trial.
  EXPECT_LE(jobsThatWere(), 13);
  std::filesystem::create_symlink(PALPATE_BIN_DIR "/palpate-worker", directory / "mended");
  std::filesystem::rename(directory / "mended", worker);
  expectFinished(*scheduler);
  EXPECT_EQ(all->wait(), 0) << all->output();
  EXPECT_TRUE(test::eventually([&] { return jobs().empty(); })) << jobs();
  EXPECT_TRUE(test::contentOf(directory / "out.h5") == undisturbed());
}

TEST_F(SlurmFaultsTest, ANodeWithoutALibraryIsExcludedAndTheOtherBuilds) {
  const std::string program = installElsewhere();
  const std::string broken = (directory / "bin" / "broken-worker").string();
  writeBrokenWorker(broken);
  // However fast this machine is, the build takes at least half a minute.
  const std::string go = (directory / "go").string();
  writeProgram(directory / "bin" / "palpate-worker",
               "#!/bin/sh\n[ \"$SLURMD_NODENAME\" = there ] && exec " + broken +
                   " \"$@\"\nwhile [ ! -e " + go + " ]; do sleep 0.1; done\n" +
                   "exec " PALPATE_BIN_DIR "/palpate-worker \"$@\"\n");
  auto scheduler = serveWide();
  auto all = fleet({"--connect", endpointIn("state"), "--most", "4"}, program);
  EXPECT_TRUE(test::says(*all, "The next job is submitted alone")) << "by then all nodes may fail";
  EXPECT_TRUE(test::says(*all, "node there is excluded")) << all->output();
  EXPECT_THAT(all->output(), HasSubstr("cannot open shared object file"));
  EXPECT_TRUE(test::says(*all, "2 workers running, 2 queued")) << all->output();
  const int before = jobsThatWere();
  EXPECT_EQ(std::string::npos, jobs().find("there")) << jobs();

  // The build ends while workers are running and waiting, and no fleet supervises them.
  all->stop(SIGKILL);
  std::ofstream(go).close();
  expectFinished(*scheduler);
  EXPECT_TRUE(test::contentOf(directory / "out.h5") == undisturbed());
  EXPECT_LE(jobsThatWere(), before) << "nothing was tried there again";
  auto again = fleet({"--most", "4"}, program);
  EXPECT_EQ(again->wait(), 0) << again->output();
  EXPECT_THAT(again->output(), HasSubstr("the build is complete: no job of palpate-"));
  EXPECT_TRUE(test::eventually([&] { return jobs().empty() && workers().empty(); })) << jobs();
}

}  // namespace
}  // namespace palpate
