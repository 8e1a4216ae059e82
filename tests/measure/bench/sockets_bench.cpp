// How fast thousands of workers connect: real sessions with their own sockets and keys, all in this
// process and without work, to a real `palpate-scheduler serve` of a paused build. Then the
// scheduler is killed and restarted, and the workers reconnect by themselves.
// Prints one JSON object. Checks nothing, because times depend on the machine.
//
//   palpate_sockets_bench [--workers 3000] [--insecure]

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <deque>
#include <memory>

#include "common/base/bytes32.hpp"
#include "common/wire/bundle.hpp"
#include "common/wire/curve.hpp"
#include "tests/support/table_worker.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/system/process.hpp"
#include "worker/link/worker_session.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The session and the socket of a worker; the solver is never needed.
class IdleWorker {
 public:
  IdleWorker(zmq::context_t& context, const std::string& endpoint,
             const std::optional<KeyFolder>& keys)
      : socket_(makeDealer(context)), mailbox_(std::make_unique<Mailbox>()) {
    SessionOptions options;
    options.endpoint = endpoint;
    options.worker_id = randomBytes(16);
    options.host = "here";
    options.pid = 1;
    options.kernel_family = "baseline";
    // As in SchedulerLink.
    if (keys) proveAsClient(socket_, *keys, endpoint);
    socket_.set(zmq::sockopt::routing_id, "w" + options.worker_id);
    if (const auto trouble = connectDealer(socket_, endpoint); !trouble.empty())
      throw failure("{}", trouble);
    session_ = std::make_unique<WorkerSession>(*mailbox_, options, Clock::now());
  }

  /// As in SchedulerLink. Returns true if the scheduler has admitted the worker.
  bool turn() {
    bool welcome = false;
    while (const auto incoming = inbox_.next(socket_, false)) {
      welcome |= incoming->message.has_welcome();
      session_->receive(*incoming, Clock::now());
    }
    if (session_->advance(Clock::now()) != WorkerSession::Next::go_on)
      throw failure("a worker does not go on");
    for (const Letter& letter : session_->takeOutbox())
      // Without a connection messages are dropped; the session repeats them.
      static_cast<void>(sendMessage(socket_, "", letter.message, letter.payload));
    return welcome;
  }

 private:
  zmq::socket_t socket_;
  std::unique_ptr<Mailbox> mailbox_;
  Inbox inbox_;
  std::unique_ptr<WorkerSession> session_;
};

/// Raises the limit of descriptors for this process and its child as far as the system allows.
void allowManyDescriptors() {
  struct rlimit limit {};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) throw failure("getrlimit: {}", errnoText());
  limit.rlim_cur = limit.rlim_max;
  if (setrlimit(RLIMIT_NOFILE, &limit) != 0) throw failure("setrlimit: {}", errnoText());
}

class Crowd {
 public:
  Crowd(std::filesystem::path directory, bool insecure)
      : directory_(std::move(directory)), insecure_(insecure) {
    test::writeEndlessScene(directory_, 3, 1);
  }

  void startScheduler(const std::string& endpoint) {
    std::vector<std::string> arguments = {"serve",   "cube.toml", "--listen", endpoint,
                                          "--state", "state",     "--quiet"};
    if (insecure_) arguments.emplace_back("--insecure");
    scheduler_.emplace("palpate-scheduler", arguments, directory_);
    if (!test::eventually([&] {
          return !test::endpointAnnouncedIn(directory_ / "state").empty() || !scheduler_->running();
        }))
      throw failure("the scheduler does not listen: {}", scheduler_->output());
  }
  std::string endpoint() const { return test::endpointAnnouncedIn(directory_ / "state"); }
  void pause() {
    test::Process command("palpate-scheduler", {"pause", endpoint()}, directory_);
    if (command.wait() != 0) throw failure("cannot pause: {}", command.output());
  }
  void killScheduler() {
    scheduler_->stop(SIGKILL);
    std::filesystem::remove(directory_ / "state" / "endpoint");
    began_ = Clock::now();
  }

  void join(zmq::context_t& context, int workers) {
    const auto keys = insecure_ ? std::nullopt : std::optional(KeyFolder(directory_ / "keys"));
    began_ = Clock::now();
    for (int n = 0; n < workers; ++n) workers_.emplace_back(context, endpoint(), keys);
  }
  /// Seconds from join() or killScheduler() until each of these shares of the workers is welcomed.
  std::vector<double> welcomed(const std::vector<double>& parts) {
    std::vector<bool> is_in(workers_.size(), false);
    std::size_t in = 0;
    std::vector<double> seconds;
    while (seconds.size() < parts.size()) {
      for (std::size_t n = 0; n < workers_.size(); ++n)
        if (workers_[n].turn() && !is_in[n]) {
          is_in[n] = true;
          ++in;
        }
      while (seconds.size() < parts.size() &&
             static_cast<double>(in) >=
                 parts[seconds.size()] * static_cast<double>(workers_.size()))
        seconds.push_back(secondsSince(began_));
      if (!scheduler_->running()) throw failure("the scheduler ended: {}", scheduler_->output());
      if (secondsSince(began_) > 120)
        throw failure("{} of {} workers are there after two minutes", in, workers_.size());
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return seconds;
  }

 private:
  std::filesystem::path directory_;
  bool insecure_;
  std::optional<test::Process> scheduler_;
  std::deque<IdleWorker> workers_;  ///< at fixed addresses
  Clock::time_point began_;
};

int run(int argc, char** argv) {
  int workers = 3000;
  bool insecure = false;
  CLI::App app{"How soon a crowd of workers is there, and back"};
  app.add_option("--workers", workers, "All in this process")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_flag("--insecure", insecure, "Without keys");
  app.footer(
      "there_after_s: from the creation of the first worker until the shares of the workers\n"
      "  in parts are connected.\n"
      "back_after_kill_s: the same from the kill of the scheduler, which is restarted at\n"
      "  once.\n"
      "The build is paused, so the workers have no work.");
  CLI11_PARSE(app, argc, argv);
  allowManyDescriptors();
  spdlog::set_level(spdlog::level::off);  // each worker would log something
  zmq::context_t context;                 // before the sockets, which must be destroyed first
  context.set(zmq::ctxopt::max_sockets, workers + 100);
  const test::TemporaryDirectory directory;
  Crowd crowd(directory.path(), insecure);
  crowd.startScheduler("tcp://127.0.0.1:*");
  crowd.pause();
  const std::string endpoint = crowd.endpoint();
  crowd.join(context, workers);
  const std::vector<double> parts = {0.5, 0.9, 1};
  const auto first = crowd.welcomed(parts);
  crowd.killScheduler();
  crowd.startScheduler(endpoint);
  const auto back = crowd.welcomed(parts);
  fmt::print(
      "{{\"workers\":{},\"keys\":{},\"parts\":[{}],\"there_after_s\":[{:.2f}],"
      "\"back_after_kill_s\":[{:.2f}]}}\n",
      workers, !insecure, fmt::join(parts, ","), fmt::join(first, ","), fmt::join(back, ","));
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    return palpate::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
