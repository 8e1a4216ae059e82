#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/ptrace.h>

#include <algorithm>
#include <fstream>

#include "tests/system/small_build.hpp"

/// What happens to machines at night, with the real programs: threads that hang, files that are
/// damaged or removed, processes that are frozen. The dataset is always the same.
namespace palpate {
namespace {

using test::Process;
using testing::HasSubstr;
using testing::Not;

/// One thread of another process, stopped until this object goes. The others go on.
class FrozenThread {
 public:
  explicit FrozenThread(pid_t thread) : thread_(thread) {
    frozen_ = ptrace(PTRACE_SEIZE, thread, nullptr, nullptr) == 0 &&
              ptrace(PTRACE_INTERRUPT, thread, nullptr, nullptr) == 0 &&
              waitpid(thread, nullptr, __WALL) == thread;
  }
  ~FrozenThread() {
    if (frozen_ && ptrace(PTRACE_DETACH, thread_, nullptr, nullptr) != 0)
      waitpid(thread_, nullptr, __WALL);  // it ended: its process waits for us to know
  }
  FrozenThread(const FrozenThread&) = delete;
  FrozenThread& operator=(const FrozenThread&) = delete;
  bool frozen() const { return frozen_; }
  /// Its process ended, which shows elsewhere only then.
  bool waitUntilItEnds() {
    frozen_ = !test::eventually([&] { return waitpid(thread_, nullptr, __WALL | WNOHANG) != 0; });
    return !frozen_;
  }

 private:
  pid_t thread_;
  bool frozen_ = false;
};

/// The thread of a worker that was made last, but for ZeroMQ's; an idle one of OpenBLAS is older.
pid_t solverThreadOf(const Process& worker) {
  pid_t solver = -1;
  const std::filesystem::path tasks = "/proc/" + std::to_string(worker.pid()) + "/task";
  for (const auto& entry : std::filesystem::directory_iterator(tasks)) {
    const pid_t thread = std::stoi(entry.path().filename().string());
    std::ifstream file(entry.path() / "comm");
    std::string name;
    std::getline(file, name);
    if (thread != worker.pid() && !name.starts_with("ZMQ")) solver = std::max(solver, thread);
  }
  return solver;
}

struct AccidentTest : test::SmallBuild {
  // Long enough that it is not over before the accident.
  AccidentTest() : SmallBuild(6) {}

  std::unique_ptr<Process> serve(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"serve",   "cube.toml", "--listen", "tcp://127.0.0.1:*",
                                          "--state", "served",    "-o",       "served.h5"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return start("palpate-scheduler", arguments);
  }
  std::unique_ptr<Process> work(const std::string& endpoint, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"work", "--alone", "--connect", endpoint};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return start("palpate-worker", arguments);
  }
  void flipInJournal(const std::string& state, std::uintmax_t byte) const {
    std::fstream file(directory / state / "segment-000001.dat",
                      std::ios::binary | std::ios::in | std::ios::out);
    file.seekg(static_cast<std::streamoff>(byte));
    const int there = file.get();
    file.seekp(static_cast<std::streamoff>(byte));
    file.put(static_cast<char>(there ^ 4));
  }
};

TEST_F(AccidentTest, AWorkerWhoseSolverHangsEndsItselfAndAnotherFinishesItsWork) {
  auto scheduler = serve({"--hung-after", "1"});
  const std::string endpoint = endpointIn("served");
  auto worker = work(endpoint);
  ASSERT_TRUE(journalGrows(*scheduler, "served", 10000));
  FrozenThread solver(solverThreadOf(*worker));
  if (!solver.frozen()) GTEST_SKIP() << "threads cannot be traced here";
  ASSERT_TRUE(solver.waitUntilItEnds());
  EXPECT_EQ(worker->wait(), 128 + SIGKILL) << worker->output();
  EXPECT_THAT(worker->output(), HasSubstr("the solver hangs"));
  auto another = work(endpoint);
  expectFinished(*scheduler);
  EXPECT_EQ(another->wait(), 0) << another->output();
  EXPECT_EQ(test::contentOf(directory / "served.h5"), undisturbed());
}

TEST_F(AccidentTest, AWorkerToldToEndSaysGoodbyeInTimeWhateverItsSolverDoes) {
  auto scheduler = serve();
  const std::string endpoint = endpointIn("served");
  auto worker = work(endpoint, {"--drain", "1"});
  ASSERT_TRUE(journalGrows(*scheduler, "served", 10000));
  FrozenThread solver(solverThreadOf(*worker));
  if (!solver.frozen()) GTEST_SKIP() << "threads cannot be traced here";
  worker->signal(SIGTERM);
  ASSERT_TRUE(solver.waitUntilItEnds());
  EXPECT_EQ(worker->wait(), 130) << worker->output();
  EXPECT_TRUE(test::eventually(
      [&] { return scheduler->output().find("left: interrupted") != std::string::npos; }));
  auto another = work(endpoint);
  expectFinished(*scheduler);
  EXPECT_THAT(scheduler->output(), Not(HasSubstr("ended unexpectedly")));
  EXPECT_EQ(test::contentOf(directory / "served.h5"), undisturbed());
}

TEST_F(AccidentTest, AKilledWorkerIsReplacedAndToldOfByItsSupervisor) {
  auto scheduler = serve();
  auto workers = start("palpate-worker", {"work", "--connect", endpointIn("served"), "-j", "2"});
  ASSERT_TRUE(journalGrows(*scheduler, "served", 10000));
  const std::vector<pid_t> children = workers->children();
  ASSERT_EQ(children.size(), 2u);
  kill(children[0], SIGKILL);
  expectFinished(*scheduler);
  EXPECT_EQ(workers->wait(), 0) << workers->output();
  EXPECT_THAT(workers->output(), HasSubstr("died of signal 9; starting another"));
  EXPECT_EQ(test::contentOf(directory / "served.h5"), undisturbed());
}

TEST_F(AccidentTest, DamageInTheJournalCostsWhatIsDamaged) {
  auto build = startBuild("out.h5", "2");
  ASSERT_TRUE(journalGrows(*build, "out.h5.state", 50000));
  build->stop(SIGKILL);
  for (const std::uintmax_t byte : {10u, 15000u, 40000u}) flipInJournal("out.h5.state", byte);
  auto again = startBuild("out.h5", "2");
  expectFinished(*again);
  EXPECT_THAT(again->output(), HasSubstr("is computed again"));
  EXPECT_EQ(test::contentOf(directory / "out.h5"), undisturbed());
}

TEST_F(AccidentTest, DamageThatShowsWhileItRunsIsMendedBeforeAnythingIsSealed) {
  auto scheduler = serve();
  const std::string endpoint = endpointIn("served");
  auto worker = work(endpoint);
  ASSERT_TRUE(journalGrows(*scheduler, "served", 20000));
  worker->stop(SIGKILL);
  // Payloads, which nobody reads before the end, most likely.
  for (const std::uintmax_t byte : {3000u, 9000u, 15000u}) flipInJournal("served", byte);
  auto supervised = start("palpate-worker", {"work", "--connect", endpoint});
  // It binds the same port again with what is left of the journal.
  const int code = scheduler->wait();
  EXPECT_TRUE(code == 0 || code == 3) << code << scheduler->output();
  EXPECT_THAT(scheduler->output(), HasSubstr("it is dropped, and computed again"));
  EXPECT_EQ(test::contentOf(directory / "served.h5"), undisturbed());
}

TEST_F(AccidentTest, AStateDirectoryThatIsTakenAwayEndsTheSchedulerWithAWord) {
  auto scheduler = serve();
  auto worker = work(endpointIn("served"));
  ASSERT_TRUE(journalGrows(*scheduler, "served", 10000));
  worker->stop(SIGKILL);
  std::filesystem::rename(directory / "served", directory / "elsewhere");
  EXPECT_EQ(scheduler->wait(), 1);
  EXPECT_THAT(scheduler->output(), HasSubstr("removed or replaced"));
  std::filesystem::rename(directory / "elsewhere", directory / "served");
  std::filesystem::remove(directory / "served" / "endpoint");
  auto again = serve();
  auto another = work(endpointIn("served"));
  expectFinished(*again);
  EXPECT_EQ(test::contentOf(directory / "served.h5"), undisturbed());
}

}  // namespace
}  // namespace palpate
