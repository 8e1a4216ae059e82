#include <dmumps_c.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gnu/libc-version.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>

#include "common/base/cpu_family.hpp"
#include "common/dataset/dataset.hpp"
#include "tests/support/command.hpp"
#include "tests/support/notify_socket.hpp"
#include "tests/system/small_build.hpp"

/// The real programs, from a scene to a sealed dataset, with kills.
namespace palpate {
namespace {

using testing::HasSubstr;

struct SystemTest : test::SmallBuild {};

TEST_F(SystemTest, RefusesAMissingFolderBeforeComputing) {
  for (const std::vector<std::string>& where : {std::vector<std::string>{"-o", "nowhere/out.h5"},
                                                {"-o", "out.h5", "--state", "nowhere/state"}}) {
    std::vector<std::string> arguments = {"build", "cube.toml", "-j", "1"};
    arguments.insert(arguments.end(), where.begin(), where.end());
    auto build = start("palpate-scheduler", arguments);
    EXPECT_EQ(build->wait(), 1);
    EXPECT_THAT(build->output(), testing::ContainsRegex("into nowhere:|no folder nowhere:"));
    EXPECT_FALSE(std::filesystem::exists(directory / "nowhere"));
  }
}

TEST_F(SystemTest, DoesNotTakeADamagedDatasetForFinishedWork) {
  const std::string whole = undisturbed();
  std::string damaged = whole;
  damaged[damaged.size() / 2] ^= 1;
  std::ofstream(directory / "damaged.h5", std::ios::binary) << damaged;
  auto build = startBuild("damaged.h5", "1");
  EXPECT_EQ(build->wait(), 2);
  EXPECT_THAT(build->output(), HasSubstr("not a usable dataset"));
  EXPECT_EQ(test::contentOf(directory / "damaged.h5"), damaged);
}

TEST_F(SystemTest, AFullDiskForTheLogEndsNoWork) {
  const test::CommandResult build = palpate("build cube.toml -o out.h5 -j 1 2> /dev/full");
  EXPECT_TRUE(build.exit_code == 0 || build.exit_code == 3) << build.exit_code;
  EXPECT_THAT(build.output, HasSubstr("sealed"));
}

TEST_F(SystemTest, AFileSizeLimitIsNamedAndTheBuildResumesWithoutIt) {
  const test::CommandResult limited = test::runCommand(
      "(cd '" + directory.path().string() +
      "' && ulimit -f 400 && " PALPATE_BIN_DIR "/palpate build cube.toml -o out.h5 -j 1 -q)");
  EXPECT_EQ(limited.exit_code, 1) << limited.output;
  EXPECT_THAT(limited.output, HasSubstr("ulimit -f"));
  auto build = startBuild("out.h5", "1");
  expectFinished(*build);
  EXPECT_EQ(test::contentOf(directory / "out.h5"), undisturbed());
}

TEST_F(SystemTest, OneWorkerAndThreeMakeTheSameFile) {
  auto build = startBuild("three.h5", "3");
  expectFinished(*build);
  EXPECT_THAT(build->output(),
              testing::AllOf(HasSubstr("tip"), HasSubstr("corner"), HasSubstr("sealed after")));
  EXPECT_EQ(test::contentOf(directory / "three.h5"), undisturbed());
}

/// The libraries on which last bits depend, besides the kernels that the test selects.
std::string librariesHere() {
  return fmt::format("GCC {}, glibc {}, MUMPS {}, Eigen {}.{}.{}", __VERSION__,
                     gnu_get_libc_version(), MUMPS_VERSION, EIGEN_WORLD_VERSION,
                     EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
}

TEST_F(SystemTest, TheShippedLiverHasTheRecordedContent) {
  // Contents of the shipped liver. A change that is meant to change forces must replace them.
  // Libraries choose code by the processor all the same: two kinds of machines are known.
  const std::vector<std::string> contents = {
      "2a5640050b464716acb532d4f7928856c1e1368f9630301d561ca6267f58e52c",
      "8022324e467c648c20adfa631f3a875f514afe6a3a84a48f48e83edae7d9e376"};
  constexpr auto* libraries = "GCC 12.2.0, glibc 2.36, MUMPS 5.5.1, Eigen 3.4.0";
  if (librariesHere() != libraries)
    GTEST_SKIP() << "the content is known with " << libraries << " and was NOT compared with "
                 << librariesHere();
  const std::string file = (directory / "liver.h5").string();
  const test::CommandResult built = test::runCommand(
      "PALPATE_KERNELS=baseline OPENBLAS_CORETYPE=Prescott GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,"
      "-FMA " PALPATE_BIN_DIR "/palpate build " PALPATE_SOURCE_DIR
      "/deploy/scenes/liver/liver.toml -q -j 2 -o " +
      file);
  EXPECT_TRUE(built.exit_code == 0 || built.exit_code == 3) << built.output;
  EXPECT_THAT(contents, ::testing::Contains(Dataset(file).contentId().hex()));
}

TEST_F(SystemTest, KillsOfSchedulersAndWorkersLeaveNoTrace) {
  int killed_schedulers = 0, killed_workers = 0;
  for (int round = 0;; ++round) {
    ASSERT_LT(round, 200);
    auto build = startBuild("killed.h5", "2");
    if (!journalGrows(*build, "killed.h5.state", 25000)) {
      expectFinished(*build);
      break;
    }
    if (round % 2 == 0) {
      for (const pid_t worker : build->workers()) killed_workers += kill(worker, SIGKILL) == 0;
      if (!journalGrows(*build, "killed.h5.state", 25000)) {
        expectFinished(*build);
        break;
      }
    }
    build->stop(SIGKILL);
    ++killed_schedulers;
  }
  EXPECT_GE(killed_schedulers, 3);
  EXPECT_GE(killed_workers, 3);
  EXPECT_EQ(test::contentOf(directory / "killed.h5"), undisturbed());
}

TEST_F(SystemTest, WorkersOverTcpMakeTheSameFileAndLeaveWhenItIsDone) {
  auto scheduler = serve("served", "served.h5");
  const std::string endpoint = endpointIn("served");
  auto first = start("palpate-worker", {"work", "--connect", endpoint, "-j", "1"});
  auto second = start("palpate-worker", {"work", "--connect", endpoint, "-j", "1"});
  expectFinished(*scheduler);
  EXPECT_EQ(first->wait(), 0) << first->output();
  EXPECT_EQ(second->wait(), 0) << second->output();
  EXPECT_EQ(test::contentOf(directory / "served.h5"), undisturbed());
}

TEST_F(SystemTest, ChildProcessesInheritAWorkersLogLevel) {
  auto scheduler = serve("served", "served.h5");
  const std::string endpoint = endpointIn("served");
  auto quiet = start("palpate-worker", {"work", "--connect", endpoint, "-j", "1", "-q"});
  auto usual = start("palpate-worker", {"work", "--connect", endpoint, "-j", "1"});
  expectFinished(*scheduler);
  EXPECT_EQ(quiet->wait(), 0);
  EXPECT_EQ(usual->wait(), 0);
  EXPECT_THAT(usual->output(), HasSubstr(" info "));
  EXPECT_THAT(quiet->output(), testing::Not(HasSubstr(" info ")));
}

/// Only the child process connects. Without a scheduler, it logs as a detail that messages are not
/// accepted.
TEST_F(SystemTest, ChildProcessesLogTheDetailsThatAWorkerIsAskedFor) {
  auto worker = start("palpate-worker", {"work", "--connect", "ipc://nobody.ipc", "-j", "1", "-v"});
  EXPECT_TRUE(test::says(*worker, " debug ")) << worker->output();
}

TEST_F(SystemTest, WorkersOutliveTheirScheduler) {
  auto scheduler = serve("served", "served.h5", {}, "ipc://scheduler.ipc");
  endpointIn("served");
  auto worker = start("palpate-worker", {"work", "--connect", "ipc://scheduler.ipc", "-j", "1"});
  ASSERT_TRUE(journalGrows(*scheduler, "served", 50000));
  scheduler->stop(SIGKILL);
  std::filesystem::remove(directory / "served" / "endpoint");
  scheduler = serve("served", "served.h5", {}, "ipc://scheduler.ipc");
  expectFinished(*scheduler);
  EXPECT_EQ(worker->wait(), 0) << worker->output();
  EXPECT_EQ(test::contentOf(directory / "served.h5"), undisturbed());
}

TEST_F(SystemTest, ASecondSchedulerIsRefusedTheSocketOfTheFirst) {
  auto first = serve("first", "first.h5", {}, "ipc://scheduler.ipc");
  endpointIn("first");
  auto second = serve("second", "second.h5", {}, "ipc://scheduler.ipc");
  EXPECT_EQ(second->wait(), 1);
  EXPECT_THAT(second->output(), HasSubstr("ipc://scheduler.ipc is in use"));
  auto worker = start("palpate-worker", {"work", "--connect", "ipc://scheduler.ipc", "-j", "1"});
  expectFinished(*first);
  EXPECT_EQ(worker->wait(), 0) << worker->output();
}

/// The file `endpoint` in the state directory names an address at which another scheduler now
/// listens.
TEST_F(SystemTest, AnotherBuildsSchedulerAtTheSameAddressIsNotMistaken) {
  std::filesystem::create_directory(directory / "other");
  writeScene(directory / "other", 2000);
  auto mine = serve("mine", "mine.h5");
  auto other = start("palpate-scheduler", {"serve", "other/cube.toml", "--listen",
                                           "tcp://127.0.0.1:*", "--state", "others"});
  endpointIn("mine");
  told("status mine");
  endpointIn("others");
  std::filesystem::copy_file(directory / "others/endpoint", directory / "mine/endpoint",
                             std::filesystem::copy_options::overwrite_existing);
  for (const std::string verb : {"status", "stop", "pause", "resume", "retry"})
    EXPECT_THAT(told(verb + " mine", 1), HasSubstr("another build"));
  EXPECT_TRUE(mine->running() && other->running());
}

TEST_F(SystemTest, AnInterruptedBuildResumes) {
  auto build = startBuild("out.h5", "2");
  ASSERT_TRUE(journalGrows(*build, "out.h5.state", 25000));
  EXPECT_EQ(build->stop(SIGINT), 130) << build->output();
  EXPECT_THAT(build->output(), HasSubstr("continues from there"));
  EXPECT_FALSE(std::filesystem::exists(directory / "out.h5"));
  auto again = startBuild("out.h5", "2");
  expectFinished(*again);
  EXPECT_THAT(again->output(), HasSubstr("continuing from "));
  auto third = startBuild("out.h5", "2");
  expectFinished(*third);
  EXPECT_THAT(third->output(), HasSubstr("nothing to do"));
}

TEST_F(SystemTest, SimultaneousSignalsCountAsOneAndLetWorkersFinish) {
  // timeout(1) signals the process, and then the process with its group.
  for (const int number : {SIGTERM, SIGINT}) {
    auto build = startBuild("out.h5", "2");
    ASSERT_TRUE(journalGrows(*build, "out.h5.state", 10000));
    const std::vector<pid_t> workers = build->workers();
    build->signal(number);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(build->stop(number), 130) << build->output();
    EXPECT_THAT(build->output(), HasSubstr("The same command continues from there"));
    EXPECT_FALSE(workers.empty());
    for (const pid_t worker : workers)
      EXPECT_NE(kill(worker, 0), 0) << "the test did not wait for it";
  }
}

TEST_F(SystemTest, StatusAndStopFindTheSchedulerThroughItsDirectory) {
  auto build = startBuild("out.h5", "1");
  ASSERT_TRUE(journalGrows(*build, "out.h5.state", 10000));
  EXPECT_THAT(told("status out.h5.state --json"),
              testing::AllOf(HasSubstr("\"name\":\"corner\""), HasSubstr("\"workers\":[{")));
  told("stop out.h5.state");
  EXPECT_EQ(build->wait(), 130);
  EXPECT_THAT(told("status out.h5.state"), HasSubstr("stopped"));
  EXPECT_THAT(told("explain out.h5.state --active tip 0 0 0"), HasSubstr("expandable"));
}

/// Started as by systemd.
TEST_F(SystemTest, AServiceManagerIsToldReadinessAndProgress) {
  const test::NotifySocket manager(directory.path());
  auto scheduler = serve("state", "out.h5");
  std::string all;
  const auto hears = [&](const std::string& word) {
    for (const std::string& message : manager.heard()) all += message + '\n';
    return all.find(word) != std::string::npos;
  };
  EXPECT_TRUE(test::eventually([&] { return hears("READY=1"); })) << all;
  EXPECT_FALSE(test::endpointAnnouncedIn(directory / "state").empty()) << "it already listens";
  EXPECT_TRUE(test::eventually([&] { return hears("STATUS=0/514 points"); })) << all;
  EXPECT_EQ(scheduler->stop(SIGTERM), 130) << scheduler->output();
  EXPECT_TRUE(hears("STOPPING=1")) << all;
}

/// One worker uses the kernels of a machine of 2004, the other those of this machine.
TEST_F(SystemTest, NewerMachinesUseCommonKernelsForTheSameBits) {
  if (cpuFamily() == CpuFamily::baseline)
    GTEST_SKIP() << "this CPU has no kernels but baseline: changing them was NOT tested";
  // If the user had chosen kernels, the workers would offer no others.
  unsetenv("PALPATE_KERNELS");
  unsetenv("OPENBLAS_CORETYPE");
  auto scheduler = serve("state", "out.h5", {"--kernels", "baseline"});
  const std::string endpoint = endpointIn("state");
  auto newer = start("palpate-worker", {"work", "--connect", endpoint});
  ASSERT_TRUE(journalGrows(*scheduler, "state", 5000)) << newer->output();
  setenv("PALPATE_KERNELS", "baseline", 1);
  setenv("OPENBLAS_CORETYPE", "Prescott", 1);
  auto older = start("palpate-worker", {"work", "--connect", endpoint});
  expectFinished(*scheduler);
  EXPECT_EQ(newer->wait(), 0) << newer->output();
  EXPECT_THAT(newer->output(), HasSubstr("this build uses the baseline/Prescott kernels"));
  EXPECT_EQ(older->wait(), 0) << older->output();
  EXPECT_THAT(older->output(), testing::Not(HasSubstr("this build uses")));
  const std::string of_old_machines = undisturbed();
  unsetenv("PALPATE_KERNELS");
  unsetenv("OPENBLAS_CORETYPE");
  EXPECT_EQ(test::contentOf(directory / "out.h5"), of_old_machines);
}

TEST_F(SystemTest, APausedBuildStaysPausedAfterAKillUntilResumed) {
  const auto ask = [&](const std::string& verb) { return told(verb + " out.h5.state"); };
  auto build = startBuild("out.h5", "2");
  ASSERT_TRUE(journalGrows(*build, "out.h5.state", 10000));
  EXPECT_THAT(ask("pause"), HasSubstr("paused; workers finish"));
  build->stop(SIGKILL);
  EXPECT_THAT(ask("status"), HasSubstr("stopped, paused"));
  auto again = startBuild("out.h5", "2");
  ASSERT_TRUE(test::says(*again, "paused by"));
  EXPECT_TRUE(  // until it announces its address, it is still reading
      test::eventually([&] { return ask("status").find("running, paused") != std::string::npos; }));
  EXPECT_THAT(ask("resume"), HasSubstr("continues"));
  expectFinished(*again);
  EXPECT_THAT(ask("pause"), HasSubstr("the next build there waits"));
  EXPECT_THAT(ask("resume"), HasSubstr("the next build there continues"));
}

TEST_F(SystemTest, APartialDatasetCanBeSealedAndQueriedDuringTheBuild) {
  auto build = startBuild("out.h5", "1");
  ASSERT_TRUE(journalGrows(*build, "out.h5.state", 25000));
  const std::string seal = "seal out.h5.state -o now.h5";
  EXPECT_THAT(told(seal), testing::AllOf(HasSubstr("unknown"), HasSubstr("sealed, partial")));
  EXPECT_THAT(told("query now.h5 --active tip --displacement 0.002 0 0"),
              HasSubstr("now.h5: this dataset is partial"));
  told("report now.h5");
  expectFinished(*build);
  told(seal);
  EXPECT_EQ(test::contentOf(directory / "now.h5"), test::contentOf(directory / "out.h5"));
  EXPECT_THAT(told(seal), HasSubstr("nothing to do"));
}

TEST_F(SystemTest, StatusOfAKilledBuildShowsNobodyAtWork) {
  auto build = startBuild("out.h5", "1");
  ASSERT_TRUE(journalGrows(*build, "out.h5.state", 10000));
  build->stop(SIGKILL);
  EXPECT_THAT(told("status out.h5.state"),
              testing::AllOf(HasSubstr("stopped"), HasSubstr(": left, "),
                             testing::Not(HasSubstr("busy")), testing::Not(HasSubstr("idle"))));
}

TEST_F(SystemTest, ASecondSchedulerAndAnotherSceneAreRefusedWithReasons) {
  auto first = serve("state", "out.h5");
  const std::string endpoint = endpointIn("state");
  auto second = serve("state", "out.h5");
  EXPECT_EQ(second->wait(), 1);
  EXPECT_THAT(second->output(), HasSubstr("in use by process " + std::to_string(first->pid())));
  auto same_port = serve("elsewhere", "other.h5", {}, endpoint);
  EXPECT_EQ(same_port->wait(), 1);
  EXPECT_THAT(same_port->output(), HasSubstr(endpoint + " is in use"));
  first->stop(SIGKILL);
  writeScene(directory.path(), 2000);
  auto other = serve("state", "out.h5");
  EXPECT_EQ(other->wait(), 2);
  EXPECT_THAT(other->output(), HasSubstr("another --state"));
}

TEST_F(SystemTest, AChangedSceneIsBuiltAndTheOldBuildKeptUnderANewName) {
  const auto built = [this](const std::string& out) {
    auto build = startBuild(out, "1");
    expectFinished(*build);
    return build->output();
  };
  built("out.h5");
  const std::string before = Dataset(directory / "out.h5").buildId().shortHex();
  const std::string content = test::contentOf(directory / "out.h5");
  writeScene(directory.path(), 2000);
  const std::string told = built("out.h5");
  const std::string aside = "out." + before + ".h5";
  EXPECT_THAT(told, HasSubstr(aside));
  EXPECT_EQ(test::contentOf(directory / aside), content);
  EXPECT_NE(Dataset(directory / "out.h5").buildId().shortHex(), before);
  EXPECT_THAT(built("out.h5"), HasSubstr("is already the dataset of this scene"));
  writeScene(directory.path(), 1700);
  auto replaced =
      start("palpate-scheduler", {"build", "cube.toml", "-o", "out.h5", "-j", "1", "--replace"});
  expectFinished(*replaced);
  EXPECT_THAT(replaced->output(), HasSubstr("sealed after"));
  // Back to the first scene, whose dataset still exists.
  writeScene(directory.path(), 1300);
  EXPECT_THAT(built(aside), HasSubstr("is already the dataset of this scene"));
}

TEST_F(SystemTest, UnfinishedWorkOfAChangedSceneResumesUnderItsNewName) {
  auto build = startBuild("out.h5", "1");
  ASSERT_TRUE(journalGrows(*build, "out.h5.state", 50'000));
  build->stop(SIGKILL);
  writeScene(directory.path(), 2000);
  auto other = startBuild("out.h5", "1");
  expectFinished(*other);
  std::smatch found;
  const std::string told = other->output();
  ASSERT_TRUE(std::regex_search(told, found, std::regex("-o (out\\.[0-9a-f]+\\.h5)"))) << told;
  writeScene(directory.path(), 1300);
  auto again = startBuild(found[1], "1");
  expectFinished(*again);
  EXPECT_THAT(again->output(), HasSubstr("continuing from "));
}

TEST_F(SystemTest, RefusesToReplaceAFileThatIsNotItsDataset) {
  std::ofstream(directory / "out.h5") << "precious";
  auto build = startBuild("out.h5", "1");
  EXPECT_EQ(build->wait(), 2);
  EXPECT_THAT(build->output(), HasSubstr("--replace"));
  EXPECT_EQ(test::contentOf(directory / "out.h5"), "precious");
}

}  // namespace
}  // namespace palpate
