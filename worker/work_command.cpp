#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <thread>

#include "worker/link/job_loop.hpp"
#include "worker/link/scheduler_link.hpp"
#include "worker/verbs.hpp"

namespace palpate {
namespace {

struct WorkOptions {
  LinkOptions link;
  int workers = 1;
};

/// The solver thread, which must end before the mailbox goes: also when the link ends with an
/// error.
struct SolverThread {
  Mailbox& mailbox;
  std::thread thread;
  ~SolverThread() {
    mailbox.forgetJobs();
    mailbox.close();
    thread.join();
  }
};

ExitCode runOneWorker(const WorkOptions& options) {
  catchInterrupts();
  const ElementKernels& kernels = chooseKernels();
  zmq::context_t context;
  Mailbox mailbox;
  SchedulerLink link(context, mailbox, kernels, options.link);
  SolverThread solver{mailbox, std::thread([&] { solveJobs(mailbox, kernels); })};
  const ExitCode end = link.run();
  if (end == ExitCode::done) spdlog::info("no more work");
  return end;
}

/// Starts `palpate-worker work ... -j 1`, which dies with this process.
pid_t startChild(const WorkOptions& options) {
  const std::string give_up = std::to_string(options.link.give_up_s),
                    drain = std::to_string(options.link.drain_s);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw failure("fork: {}", errnoText());
  if (child > 0) return child;
  // Not SIGKILL: what is solved when the parent dies is still delivered.
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(1);
  execl("/proc/self/exe", "palpate-worker", "work", "--connect", options.link.endpoint.c_str(),
        "-j", "1", "--give-up", give_up.c_str(), "--drain", drain.c_str(),
        static_cast<char*>(nullptr));
  _exit(127);
}

/// Keeps N workers running. One that dies by a signal is replaced, unless it lived so short that
/// replacing it is pointless.
ExitCode superviseWorkers(const WorkOptions& options) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::seconds short_life{10};
  catchInterrupts();
  std::map<pid_t, Clock::time_point> children;  // and when each was started
  const auto start = [&] { children[startChild(options)] = Clock::now(); };
  for (int n = 0; n < options.workers; ++n) start();

  ExitCode result = ExitCode::done;
  bool forwarded = false;
  while (!children.empty()) {
    if (interrupted() && !forwarded) {
      for (const auto& [pid, started] : children) kill(pid, SIGTERM);
      forwarded = true;
    }
    int status = 0;
    const pid_t pid = waitpid(-1, &status, WNOHANG);
    if (pid < 0 && errno != EINTR) throw failure("waitpid: {}", errnoText());
    if (pid <= 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      continue;
    }
    const auto child = children.extract(pid);
    if (child.empty()) continue;  // of the shell whose place this program took
    const bool killed = WIFSIGNALED(status) && !interrupted();
    if (killed && Clock::now() - child.mapped() > short_life) {
      spdlog::warn("worker {} died of signal {}; starting another", pid, WTERMSIG(status));
      start();
      continue;
    }
    if (killed)
      spdlog::error("worker {} died of signal {} right after its start", pid, WTERMSIG(status));
    // 1 is a failure that says why; 130 and 0 are what was asked for.
    if (killed || (WIFEXITED(status) && WEXITSTATUS(status) == 1)) result = ExitCode::failed;
  }
  return interrupted() ? ExitCode::interrupted : result;
}

std::function<ExitCode()> prepareWork(CLI::App& app) {
  auto options = std::make_shared<WorkOptions>();
  app.add_option("--connect", options->link.endpoint, "The scheduler, tcp://HOST:PORT")
      ->capture_default_str();
  app.add_option("-j,--workers", options->workers, "Worker processes; each uses one core")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_option("--give-up", options->link.give_up_s,
                 "End after this many seconds without a word from the scheduler")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--drain", options->link.drain_s,
                 "On SIGTERM, wait at most this many seconds for the solve in work")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.footer(
      "Workers keep nothing: start and stop them at any time, "
      "on any machine that reaches the scheduler.");
  return [options] {
    checkEndpoint(options->link.endpoint);
    return options->workers == 1 ? runOneWorker(*options) : superviseWorkers(*options);
  };
}

}  // namespace

const Verb work_verb = {"work", "Solve for a scheduler, on this or any other machine", prepareWork};

}  // namespace palpate
