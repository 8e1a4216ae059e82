#include "worker/link/scheduler_link.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>

#include "common/base/program.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds poll_interval{50};

/// Makes the system end this process (SIGALRM) about one second after `drain_s`. This is the last
/// resort, for a thread that waits forever for a lock that the solver thread holds.
void endAnyway(double drain_s) { alarm(static_cast<unsigned>(std::ceil(drain_s)) + 1); }

}  // namespace

SchedulerLink::SchedulerLink(zmq::context_t& context, Mailbox& mailbox, SessionOptions options,
                             std::optional<KeyFolder> keys)
    : context_(context), mailbox_(mailbox), options_(std::move(options)), keys_(std::move(keys)) {}

void SchedulerLink::connect() {
  handshakes_.reset();
  socket_ = makeDealer(context_);
  // Keys are read for each connection, because they may be replaced while workers run.
  if (keys_) proveAsClient(socket_, *keys_, options_.endpoint);
  handshakes_.emplace(context_, socket_);
  // The prefix is needed because the random id may begin with a zero byte, which ZeroMQ reserves.
  socket_.set(zmq::sockopt::routing_id, "w" + options_.worker_id);
  tellTrouble(connectDealer(socket_, options_.endpoint));
}

/// Logs why the scheduler cannot be reached, if the reason is new. The worker keeps trying, because
/// meanwhile its key may be admitted, or the host name may become known.
void SchedulerLink::tellTrouble(std::string trouble) {
  if (trouble.empty() || trouble == told_) return;
  spdlog::warn("cannot reach {}: {}; trying again", options_.endpoint, trouble);
  told_ = std::move(trouble);
}

ExitCode SchedulerLink::run() {
  connect();
  WorkerSession session(mailbox_, options_, Clock::now());
  for (bool draining = false;;) {
    waitForMessages(socket_, poll_interval, mailbox_.wakeUpDescriptor());
    tellTrouble(handshakes_->trouble());
    while (const auto incoming = inbox_.next(socket_, false))
      session.receive(*incoming, Clock::now());
    if (interrupted() && !std::exchange(draining, true)) {
      endAnyway(options_.drain_s);
      session.interrupt(Clock::now());
    }
    const WorkerSession::Next next = session.advance(Clock::now());
    for (const Letter& letter : session.takeOutbox())
      if (sendMessage(socket_, "", letter.message, letter.payload) != Sent::yes)
        spdlog::debug("the scheduler does not accept messages at the moment");
    switch (next) {
      case WorkerSession::Next::go_on: break;
      case WorkerSession::Next::connect:
        connect();
        session.connected(Clock::now());
        break;
      case WorkerSession::Next::anew:
        wanted_kernels_ = session.wantedKernels();
        return ExitCode::done;
      case WorkerSession::Next::end:
        // LINGER was 0 until now. The new value gives the goodbye a moment to leave.
        socket_.set(zmq::sockopt::linger, 500);
        return session.exitCode();
      case WorkerSession::Next::killed:
        // Only SIGKILL ends a thread that never returns.
        raise(SIGKILL);
        std::abort();
    }
  }
}

}  // namespace palpate
