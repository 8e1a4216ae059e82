#include "worker/work_command.hpp"

#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "worker/link/job_loop.hpp"
#include "worker/link/scheduler_link.hpp"

namespace palpate {
namespace {

struct WorkOptions {
  std::string endpoint = default_endpoint;
  int workers = 1;
  double give_up_s = 15 * 60;
  double drain_s = 10;
};

ExitCode runOneWorker(const WorkOptions& options) {
  catchInterrupts();
  const ElementKernels& kernels = chooseKernels();
  zmq::context_t context;
  Mailbox mailbox;
  LinkOptions link_options;
  link_options.endpoint = options.endpoint;
  link_options.give_up =
      std::chrono::milliseconds(static_cast<std::int64_t>(1000 * options.give_up_s));
  link_options.drain = std::chrono::milliseconds(static_cast<std::int64_t>(1000 * options.drain_s));
  SchedulerLink link(context, mailbox, kernels, link_options);

  std::thread solver([&] { solveJobs(mailbox, kernels); });
  const auto stopSolver = [&] {
    mailbox.forgetJobs();
    mailbox.close();
  };
  LinkEnd end = LinkEnd::given_up;
  try {
    end = link.run();
  } catch (...) {
    stopSolver();
    solver.join();
    throw;
  }
  stopSolver();
  solver.join();
  switch (end) {
    case LinkEnd::finished:
      spdlog::info("no more work");
      return ExitCode::done;
    case LinkEnd::interrupted:
      return ExitCode::interrupted;
    case LinkEnd::given_up:
      break;
  }
  throw failure("no word from {} for {} s: is the scheduler running, and is this its address?",
                options.endpoint, options.give_up_s);
}

/// Starts `palpate-worker work ... -j 1`, which dies with this process.
pid_t startChild(const WorkOptions& options) {
  const std::string give_up = std::to_string(options.give_up_s),
                    drain = std::to_string(options.drain_s);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw failure("fork: {}", errnoText());
  if (child > 0) return child;
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(1);
  execl("/proc/self/exe", "palpate-worker", "work", "--connect", options.endpoint.c_str(), "-j",
        "1", "--give-up", give_up.c_str(), "--drain", drain.c_str(), static_cast<char*>(nullptr));
  _exit(127);
}

/// Keeps N workers running. One that dies by a signal is replaced, unless it lived so short that
/// replacing it is pointless.
ExitCode superviseWorkers(const WorkOptions& options) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::seconds short_life{10};
  catchInterrupts();
  struct Child {
    pid_t pid;
    Clock::time_point started;
  };
  std::vector<Child> children;
  children.reserve(options.workers);
  for (int n = 0; n < options.workers; ++n) children.push_back({startChild(options), Clock::now()});

  ExitCode result = ExitCode::done;
  bool forwarded = false;
  while (!children.empty()) {
    if (interrupted() && !forwarded) {
      for (const Child& child : children) kill(child.pid, SIGTERM);
      forwarded = true;
    }
    int status = 0;
    const pid_t pid = waitpid(-1, &status, WNOHANG);
    if (pid < 0 && errno != EINTR) throw failure("waitpid: {}", errnoText());
    if (pid <= 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      continue;
    }
    for (auto child = children.begin(); child != children.end(); ++child) {
      if (child->pid != pid) continue;
      const bool killed = WIFSIGNALED(status) && !interrupted();
      if (killed && Clock::now() - child->started > short_life) {
        spdlog::warn("worker {} died of signal {}; starting another", pid, WTERMSIG(status));
        *child = {startChild(options), Clock::now()};
        break;
      }
      if (killed)
        spdlog::error("worker {} died of signal {} right after its start", pid, WTERMSIG(status));
      if (killed || (WIFEXITED(status) && WEXITSTATUS(status) == 1)) result = ExitCode::failed;
      children.erase(child);
      break;
    }
  }
  return interrupted() ? ExitCode::interrupted : result;
}

std::function<ExitCode()> prepareWork(CLI::App& app) {
  auto options = std::make_shared<WorkOptions>();
  app.add_option("--connect", options->endpoint, "The scheduler, tcp://HOST:PORT")
      ->capture_default_str();
  app.add_option("-j,--workers", options->workers, "Worker processes; each uses one core")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_option("--give-up", options->give_up_s,
                 "End after this many seconds without a word from the scheduler")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--drain", options->drain_s,
                 "On SIGTERM, wait at most this many seconds for the solve in work")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.footer(
      "Workers keep nothing: start and stop them at any time, "
      "on any machine that reaches the scheduler.");
  return [options] {
    checkEndpoint(options->endpoint);
    return options->workers == 1 ? runOneWorker(*options) : superviseWorkers(*options);
  };
}

}  // namespace

const Verb work_verb = {"work", "Solve for a scheduler, on this or any other machine", prepareWork};

}  // namespace palpate
