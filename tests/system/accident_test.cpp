#include <elf.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/ptrace.h>
#include <sys/uio.h>
#include <sys/user.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>

#include "tests/support/long_tests.hpp"
#include "tests/system/small_build.hpp"

/// Accidents of machines with the real programs: threads that hang, files that are damaged or
/// removed, processes that are frozen. The dataset is always the same.
namespace palpate {
namespace {

using test::Process;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// The instruction pointer of a stopped thread; 0 if unknown on this processor.
std::uintptr_t instructionOf(pid_t thread) {
  user_regs_struct registers{};
  iovec all{&registers, sizeof registers};
  if (ptrace(PTRACE_GETREGSET, thread, NT_PRSTATUS, &all) != 0) return 0;
#if defined(__x86_64__)
  return registers.rip;
#elif defined(__aarch64__)
  return registers.pc;
#else
  return 0;
#endif
}

/// The file (or [vdso] and the like) with the code at `address` in the process of `thread`.
std::string codeAt(pid_t thread, std::uintptr_t address) {
  std::ifstream maps("/proc/" + std::to_string(thread) + "/maps");
  for (std::string line; std::getline(maps, line);) {
    std::uintptr_t from = 0, to = 0;
    int path = 0;
    if (std::sscanf(line.c_str(), "%lx-%lx %*s %*s %*s %*s %n", &from, &to, &path) == 2 &&
        from <= address && address < to)
      return line.substr(static_cast<std::size_t>(path));
  }
  return {};
}

/// One thread of another process, stopped until this object is destroyed; the other threads run on.
/// It is stopped inside the solver's code, because inside malloc it would hold a lock that all
/// threads need.
class FrozenThread {
 public:
  explicit FrozenThread(pid_t thread) : thread_(thread) {
    if (ptrace(PTRACE_SEIZE, thread, nullptr, nullptr) != 0) {
      why_not_ = "threads cannot be traced here";
      return;
    }
    frozen_ = true;
    if (!test::eventually([&] { return !frozen_ || stopsInSolver(); }))
      why_not_ = "the thread was never met in code of the solver";
  }
  ~FrozenThread() {
    if (frozen_ && ptrace(PTRACE_DETACH, thread_, nullptr, nullptr) != 0)
      waitpid(thread_, nullptr, __WALL);  // it has ended: its process waits until this is noticed
  }
  FrozenThread(const FrozenThread&) = delete;
  FrozenThread& operator=(const FrozenThread&) = delete;
  /// Empty if the thread is stopped.
  const std::string& whyNot() const { return why_not_; }
  /// Waits for the end of the process, which others see only after this.
  bool waitUntilItEnds() {
    frozen_ = !test::eventually([&] { return waitpid(thread_, nullptr, __WALL | WNOHANG) != 0; });
    return !frozen_;
  }

 private:
  /// Stops the thread; lets it continue if it may hold locks that others need.
  bool stopsInSolver() {
    int status = 0;
    if (ptrace(PTRACE_INTERRUPT, thread_, nullptr, nullptr) != 0 ||
        waitpid(thread_, &status, __WALL) != thread_ || !WIFSTOPPED(status)) {
      frozen_ = false;
      why_not_ = "the thread ended";
      return false;
    }
    const std::uintptr_t instruction = instructionOf(thread_);
    if (instruction == 0) {
      why_not_ = "where a thread is cannot be told on this processor";
      return true;
    }
    const std::string code = codeAt(thread_, instruction);
    const auto within = [&](const char* name) { return code.find(name) != std::string::npos; };
    if (!code.empty() && std::ranges::none_of(std::array{"/libc.", "/libc-", "/ld-", "/libpthread",
                                                         "/libstdc++", "/libzmq", "[v", "san.so"},
                                              within))
      return true;
    // Pass on a signal that arrived before this test stopped the thread.
    const bool ours = status >> 16 == PTRACE_EVENT_STOP;
    ptrace(PTRACE_CONT, thread_, nullptr, ours ? 0L : static_cast<long>(WSTOPSIG(status)));
    return false;
  }

  pid_t thread_;
  bool frozen_ = false;
  std::string why_not_;
};

/// The worker's newest thread, except for those of ZeroMQ.
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
  // The body is so large that the build is not complete before the accident.
  AccidentTest() : SmallBuild(6) {}

  std::unique_ptr<Process> serve(const std::vector<std::string>& more = {}) {
    return SmallBuild::serve("served", "served.h5", more);
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

TEST_F(AccidentTest, AWorkerWithAHungSolverEndsAndAnotherFinishesItsWork) {
  // Much longer than any solve on a busy machine, because the limit also applies to the second
  // worker.
  auto scheduler = serve({"--hung-after", "10"});
  const std::string endpoint = endpointIn("served");
  auto worker = work(endpoint);
  ASSERT_TRUE(journalGrows(*scheduler, "served", 10000));
  FrozenThread solver(solverThreadOf(*worker));
  if (!solver.whyNot().empty()) GTEST_SKIP() << "NOT tested: " << solver.whyNot();
  ASSERT_TRUE(solver.waitUntilItEnds());
  EXPECT_EQ(worker->wait(), 128 + SIGKILL) << worker->output();
  EXPECT_THAT(worker->output(), HasSubstr("the solver hangs"));
  auto another = work(endpoint);
  expectFinished(*scheduler);
  EXPECT_EQ(another->wait(), 0) << another->output();
  EXPECT_EQ(test::contentOf(directory / "served.h5"), undisturbed());
}

TEST_F(AccidentTest, AWorkerToldToEndSaysGoodbyeInTimeDespiteItsSolver) {
  auto scheduler = serve();
  const std::string endpoint = endpointIn("served");
  auto worker = work(endpoint, {"--drain", "1"});
  ASSERT_TRUE(journalGrows(*scheduler, "served", 10000));
  FrozenThread solver(solverThreadOf(*worker));
  if (!solver.whyNot().empty()) GTEST_SKIP() << "NOT tested: " << solver.whyNot();
  worker->signal(SIGTERM);
  ASSERT_TRUE(solver.waitUntilItEnds());
  EXPECT_EQ(worker->wait(), 130) << worker->output();
  EXPECT_TRUE(test::says(*scheduler, "left: interrupted"));
  auto another = work(endpoint);
  expectFinished(*scheduler);
  EXPECT_THAT(scheduler->output(), Not(HasSubstr("ended unexpectedly")));
  EXPECT_EQ(test::contentOf(directory / "served.h5"), undisturbed());
}

TEST_F(AccidentTest, AKilledWorkerIsReplacedAndReportedByItsSupervisor) {
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

TEST_F(AccidentTest, DamageInTheJournalLosesOnlyDamagedRecords) {
  auto build = startBuild("out.h5", "2");
  ASSERT_TRUE(journalGrows(*build, "out.h5.state", 50000));
  build->stop(SIGKILL);
  for (const std::uintmax_t byte : {10u, 15000u, 40000u}) flipInJournal("out.h5.state", byte);
  auto again = startBuild("out.h5", "2");
  expectFinished(*again);
  EXPECT_THAT(again->output(), HasSubstr("computed again"));
  EXPECT_EQ(test::contentOf(directory / "out.h5"), undisturbed());
}

TEST_F(AccidentTest, DamageFoundDuringTheRunIsRepairedBeforeSealing) {
  auto scheduler = serve();
  const std::string endpoint = endpointIn("served");
  auto worker = work(endpoint);
  ASSERT_TRUE(journalGrows(*scheduler, "served", 20000));
  worker->stop(SIGKILL);
  // These bytes are most likely in payloads, which are not read before the end.
  for (const std::uintmax_t byte : {3000u, 9000u, 15000u}) flipInJournal("served", byte);
  auto supervised = start("palpate-worker", {"work", "--connect", endpoint});
  // The scheduler restarts by itself, on the same port, with the rest of the journal.
  const int code = scheduler->wait();
  EXPECT_TRUE(code == 0 || code == 3) << code << scheduler->output();
  EXPECT_THAT(scheduler->output(), HasSubstr("it is dropped, and its result computed again"));
  EXPECT_EQ(test::contentOf(directory / "served.h5"), undisturbed());
}

TEST_F(AccidentTest, ARemovedStateDirectoryEndsTheSchedulerWithAnError) {
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

TEST_F(AccidentTest, ASuspendedMachineLosesNoWorker) {
  // In long tests, the machine sleeps longer than the silence after which a worker counts as lost.
  const std::chrono::seconds asleep(test::longTestsAreWanted() ? 65 : 4);
  auto build = startBuild("out.h5", "2");
  ASSERT_TRUE(journalGrows(*build, "out.h5.state", 10000));
  const std::vector<pid_t> workers = build->workers();
  build->signal(SIGSTOP);
  for (const pid_t worker : workers) kill(worker, SIGSTOP);
  std::this_thread::sleep_for(asleep);
  for (const pid_t worker : workers) kill(worker, SIGCONT);
  build->signal(SIGCONT);
  expectFinished(*build);
  EXPECT_THAT(build->output(), AllOf(HasSubstr("this scheduler did nothing for"),
                                     Not(HasSubstr("other workers get its"))));
  EXPECT_EQ(test::contentOf(directory / "out.h5"), undisturbed());
}

}  // namespace
}  // namespace palpate
