#pragma once

#include <list>
#include <tuple>

#include "common/base/error.hpp"
#include "common/wire/wire.hpp"
#include "worker/elements/kernel_family.hpp"
#include "worker/link/mailbox.hpp"

namespace palpate {

/// 16 random bytes.
std::string randomWorkerId();

struct LinkOptions {
  /// Of the scheduler, as checkEndpoint() wants it.
  std::string endpoint = default_endpoint;
  /// The worker ends without any word from the scheduler for this long.
  double give_up_s = 15 * 60;
  /// On SIGTERM: how long to wait until the target in work is done and acknowledged.
  double drain_s = 10;
  /// Its own name, 1 to 64 bytes, and those of the workers in whose place it was started because
  /// their processes ended, which the scheduler is told.
  std::string worker_id = randomWorkerId();
  std::vector<std::string> ended;
};

/// A worker's side of the protocol (docs/wire.md): says hello, asks for work, fetches start
/// configurations, delivers results and keeps each until it is acknowledged. Whatever happens to
/// the scheduler, it asks again and delivers again.
///
/// run() is the network thread; it owns the socket. The solver thread is on the other side of the
/// mailbox.
class SchedulerLink {
 public:
  SchedulerLink(zmq::context_t& context, Mailbox& mailbox, const ElementKernels& kernels,
                LinkOptions options);

  /// Serves until there is no more work (done), or SIGINT or SIGTERM came and what was in work was
  /// delivered or handed back (interrupted), within LinkOptions::drain_s whatever the solver does.
  /// Error when the scheduler refuses this worker or says nothing for LinkOptions::give_up_s, when
  /// the solver thread gave up. A solve that hangs ends the process (SIGKILL).
  ExitCode run();

 private:
  using Clock = std::chrono::steady_clock;
  /// (space, target, parent): the key of a result.
  using ResultKey = std::tuple<std::uint32_t, LatticePoint, LatticePoint>;

  void connect();
  void sayHello();
  void send(const wire::Message& message, std::string_view payload = {});
  void requestJobs(std::uint32_t credit);
  void handle(const Incoming& incoming);
  void handleWelcome(const wire::Welcome& welcome);
  void handleProblem(const wire::ProblemReply& reply, const std::string& payload);
  void handleJob(const wire::Job& job);
  void handleFields(const wire::FieldsReply& reply, const std::string& payload);
  void handleHeartbeat(const wire::HeartbeatReply& reply);
  void deliverFinished();
  void deliver(const FinishedTarget& finished);
  void deliverAgain();
  void introduceAgain();
  void beat();
  void forgetWork();
  void drain();
  void sayGoodbye(const char* reason);
  void forgiveOwnGap();
  void startReadyJobs();
  std::shared_ptr<const NodalFields> cached(const ContentId& id);
  void remember(const ContentId& id, const std::string& payload);

  zmq::context_t& context_;
  Mailbox& mailbox_;
  const ElementKernels& kernels_;
  const LinkOptions options_;
  zmq::socket_t socket_;

  std::string incarnation_;  ///< of the scheduler; empty before Welcome
  ContentId build_;
  std::shared_ptr<const Problem> problem_;
  std::chrono::milliseconds heartbeat_{1000};
  Clock::time_point last_turn_, last_heard_, last_sent_hello_, last_beat_, last_connected_,
      last_delivered_;
  bool draining_ = false;  ///< no more jobs are asked for
  bool finished_ = false;  ///< Drain said the build is complete

  std::deque<wire::Job> waiting_;  ///< jobs whose start configuration is not here yet
  std::map<ResultKey, FinishedTarget> unacknowledged_;
  /// Start configurations of this problem, least recently used last.
  std::list<std::pair<ContentId, std::shared_ptr<const NodalFields>>> cache_;
};

}  // namespace palpate
