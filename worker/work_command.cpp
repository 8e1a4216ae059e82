#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <deque>
#include <future>
#include <list>
#include <memory>
#include <thread>

#include "common/base/assertion.hpp"
#include "common/base/bytes32.hpp"
#include "common/base/child_process.hpp"
#include "common/keys/key_options.hpp"
#include "worker/elements/blas_kernels.hpp"
#include "worker/elements/kernel_family.hpp"
#include "worker/link/job_loop.hpp"
#include "worker/link/scheduler_link.hpp"
#include "worker/verbs.hpp"

namespace palpate {
namespace {

/// Reverses hexOf(), for the command line of a child.
std::string bytesOfHex(const std::string& hex) {
  if (hex.size() % 2 != 0 || hex.find_first_not_of("0123456789abcdef") != std::string::npos)
    throw CLI::ValidationError("\"" + hex + "\" is not the hexadecimal id of a worker");
  std::string bytes;
  for (std::size_t at = 0; at < hex.size(); at += 2)
    bytes.push_back(static_cast<char>(std::stoi(hex.substr(at, 2), nullptr, 16)));
  return bytes;
}

/// Options of the command line; `session` is only partly set.
struct WorkOptions {
  SessionOptions session;
  KeyOptions keys;
  int workers = 1;
  bool alone = false;  ///< no supervisor watches this process

  void addTo(CLI::App& app) {
    app.option_defaults()->always_capture_default();
    app.add_option("--connect", session.endpoint, "The scheduler, tcp://HOST:PORT");
    app.add_option("-j,--workers", workers, "Worker processes; each uses one core")
        ->check(CLI::Range(1, 4096));
    app.add_option("--give-up", session.give_up_s,
                   "End after this many seconds without a message from the scheduler")
        ->check(CLI::PositiveNumber);
    app.add_option("--drain", session.drain_s,
                   "On SIGTERM, wait at most this many seconds for the running solve")
        ->check(CLI::NonNegativeNumber);
    app.add_option("--leave-idle", session.leave_idle_s,
                   "Leave after this many seconds without work; 0: never")
        ->check(CLI::NonNegativeNumber);
    keys.addTo(app, "Connect without a key, to a scheduler that asks for none");
    // Options from a supervisor to its children.
    app.add_flag("--alone", alone)->group("");
    app.add_option("--id", session.worker_id)->transform(bytesOfHex)->group("");
    app.add_option("--ended", session.ended)->transform(bytesOfHex)->group("");
    app.footer(
        "Workers store nothing. Start and stop them at any time, on any machine that reaches the "
        "scheduler.");
  }
};

/// The solver thread. A solve cannot be interrupted, and a hung solve never ends. So the destructor
/// waits only for a moment. If the thread is still busy then, it is left running.
class SolverThread {
 public:
  SolverThread(std::shared_ptr<Mailbox> mailbox, const ElementKernels& kernels)
      : mailbox_(std::move(mailbox)), ended_(std::make_shared<std::promise<void>>()) {
    thread_ = std::thread([mailbox = mailbox_, ended = ended_, &kernels] {
      solveJobs(*mailbox, kernels);
      ended->set_value();
    });
  }
  ~SolverThread() {
    mailbox_->forgetJobs();
    mailbox_->close();
    constexpr std::chrono::milliseconds moment{200};
    if (ended_->get_future().wait_for(moment) == std::future_status::ready) {
      thread_.join();
    } else {
      thread_.detach();
      solver_left_running = true;
    }
  }

 private:
  std::shared_ptr<Mailbox> mailbox_;
  std::shared_ptr<std::promise<void>> ended_;
  std::thread thread_;
};

std::string hostName() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

std::string randomWorkerId() { return randomBytes(16); }

ExitCode runOneWorker(const WorkOptions& options, std::optional<KeyFolder> keys) {
  catchInterrupts();
  prepareBlas();  // a worker that cannot solve must fail before it gets work
  const ElementKernels& kernels = chooseKernels();
  SessionOptions session = options.session;
  if (session.worker_id.empty()) session.worker_id = randomWorkerId();
  session.host = hostName();
  session.pid = static_cast<std::uint32_t>(getpid());
  session.kernel_family = arithmetic(kernels);
  session.runs = otherArithmetic();
  std::string wanted_kernels;
  {
    zmq::context_t context;
    const auto mailbox = std::make_shared<Mailbox>();
    SchedulerLink link(context, *mailbox, std::move(session), std::move(keys));
    const SolverThread solver(mailbox, kernels);
    const ExitCode end = link.run();
    wanted_kernels = link.wantedKernels();
    if (wanted_kernels.empty()) {
      if (end == ExitCode::done) spdlog::info("no more work");
      return end;
    }
  }
  spdlog::info("this build uses the {} kernels; restarting with them", wanted_kernels);
  beginAnewWith(wanted_kernels);
}

using Clock = std::chrono::steady_clock;

/// Starts a worker with the options of this process. It ends when this process ends.
std::unique_ptr<ChildProcess> startWorker(const std::string& id,
                                          const std::vector<std::string>& ended) {
  std::vector<std::string> words = commandLine();
  words.insert(words.end(), {"--alone", "--id", hexOf(id)});
  for (const std::string& other : ended) words.insert(words.end(), {"--ended", hexOf(other)});
  // If this process dies, the child gets SIGTERM and not SIGKILL, so that it delivers the work in
  // progress. This file may be replaced while the supervisor runs; its workers stay the same
  // program.
  return std::make_unique<ChildProcess>(
      std::move(words), ChildSettings{.program = "/proc/self/exe", .death_signal = SIGTERM});
}

/// Keeps the requested number of workers running. A worker that dies is replaced, after a pause if
/// it lived only briefly. The new worker reports the death to the scheduler, which sets aside
/// transitions that kill workers again and again.
class Supervisor {
 public:
  explicit Supervisor(const WorkOptions& options) : options_(&options) {}

  ExitCode run() {
    catchInterrupts();
    for (int n = 0; n < options_->workers; ++n) start();
    while (!children_.empty() || !pauses_.empty()) {
      if (interrupted()) endOthers();
      while (!pauses_.empty() && Clock::now() >= pauses_.front()) {
        pauses_.pop_front();
        start();
      }
      const std::size_t before = children_.size();
      std::erase_if(children_, [&](const Child& child) {
        const bool ended = !child.process->running();
        if (ended && !ending_) takeEnd(child);
        return ended;
      });
      if (children_.size() == before) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return interrupted() ? ExitCode::interrupted : result_;
  }

 private:
  static constexpr std::chrono::seconds short_life{10};
  static constexpr std::chrono::milliseconds first_pause{500};
  /// If this many workers in a row die right after their start, the cause is probably the machine
  /// and not the work. The last one is then not replaced.
  static constexpr int most_short_lives = 8;

  /// A process that the supervisor keeps running.
  struct Child {
    std::string id;  ///< id by which the scheduler knows this worker
    Clock::time_point started;
    std::unique_ptr<ChildProcess> process;
  };

  void start() {
    PALPATE_ASSERT(std::ssize(children_) < options_->workers,
                   "a worker must replace one that ended");
    const std::string id = randomWorkerId();
    children_.push_back({id, Clock::now(), startWorker(id, ended_)});
    ended_.clear();
  }

  void endOthers() {
    pauses_.clear();
    if (std::exchange(ending_, true)) return;
    for (const Child& child : children_) child.process->send(SIGTERM);
  }

  void takeEnd(const Child& child) {
    const int signal = child.process->signal();
    if (signal == 0) {
      // A worker that exits with an error reports why: it was refused, the scheduler is silent, or
      // memory is short. A replacement would fail as well.
      const bool done = child.process->exitCode() == static_cast<int>(ExitCode::done);
      if (!done) result_ = ExitCode::failed;
      // This worker ended because the scheduler has no more work, so workers that have not reached
      // the scheduler yet would wait in vain. With --leave-idle, however, a worker may have ended
      // only because it was idle itself.
      if (done && options_->session.leave_idle_s == 0) endOthers();
      return;
    }
    ended_.push_back(child.id);
    const bool lived_short = Clock::now() - child.started < short_life;
    short_lives_ = lived_short ? short_lives_ + 1 : 0;
    if (short_lives_ >= most_short_lives) {
      spdlog::error(
          "worker {} died of signal {} right after its start, like {} before it; giving up",
          child.process->id(), signal, most_short_lives - 1);
      result_ = ExitCode::failed;
      return;
    }
    spdlog::warn("worker {} died of signal {}; starting another", child.process->id(), signal);
    pauses_.push_back(Clock::now() + short_lives_ * first_pause);
  }

  const WorkOptions* options_;
  std::list<Child> children_;
  std::deque<Clock::time_point> pauses_;  ///< times at which to start another worker, ascending
  std::vector<std::string> ended_;        ///< dead workers to report to the scheduler
  int short_lives_ = 0;                   ///< number of short lives in a row
  bool ending_ = false;                   ///< all children were asked to end
  ExitCode result_ = ExitCode::done;
};

ExitCode work(const WorkOptions& options) {
  checkEndpoint(options.session.endpoint);
  auto keys = options.keys.keys();  // here, so that a supervisor too reports missing keys
  return options.alone ? runOneWorker(options, std::move(keys)) : Supervisor(options).run();
}

}  // namespace

bool solver_left_running = false;

const Verb work_verb = {"work", "Solve for a scheduler, on this or any other machine",
                        prepareVerb<WorkOptions, work>};

}  // namespace palpate
