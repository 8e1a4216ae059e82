#pragma once

#include <list>

#include "common/base/program.hpp"
#include "common/wire/bundle.hpp"
#include "worker/link/mailbox.hpp"

namespace palpate {

/// A worker's scheduler, identity and timeouts.
struct SessionOptions {
  /// Address of the scheduler, as checkEndpoint() accepts it.
  std::string endpoint = default_endpoint;
  /// This worker's id (1 to 64 bytes) and the ids of the dead workers that it replaces. The
  /// scheduler is told both.
  std::string worker_id;
  std::vector<std::string> ended = {};
  std::string host;
  std::uint32_t pid = 0;
  std::string kernel_family;           ///< as arithmetic() returns it
  std::vector<std::string> runs = {};  ///< otherArithmetic() of this worker
  /// The worker ends after this long without a message from the scheduler.
  double give_up_s = 15 * 60;
  /// The worker leaves after this long without work. 0: never.
  double leave_idle_s = 0;
  /// Time after an interrupt within which the current target must be solved and acknowledged.
  double drain_s = 10;
};

/// A worker's side of the protocol (docs/internals/wire.md). It says hello, asks for work, fetches
/// start configurations, delivers results and keeps each result until it is acknowledged. After any
/// failure of the scheduler it repeats its requests and deliveries.
///
/// The caller passes messages and the time, so a WorkerSession needs neither a socket nor a clock.
/// One thread; the solver is on the other side of the mailbox.
class WorkerSession {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// `mailbox` must outlive this object.
  WorkerSession(Mailbox& mailbox, SessionOptions options, Time now);

  /// Handles a message. Error if the scheduler refuses this worker.
  void receive(const Incoming& incoming, Time now);

  /// The caller's next action after advance().
  enum class Next : std::uint8_t {
    go_on,    ///< call advance() again after messages, a wake-up or 50 ms
    connect,  ///< the scheduler was silent for long: reconnect, then call connected()
    end,      ///< end the process with exitCode(); the goodbye is sent
    anew,     ///< restart with wantedKernels(), as the same worker
    killed    ///< the solver hangs: end at once, without a message
  };
  /// Handles timeouts and finished targets. Call after every batch of messages. Error if the
  /// scheduler is silent for give_up_s, or if the solver thread failed.
  Next advance(Time now);
  void connected(Time now);
  /// Returns the messages to be sent, in order. A lost message does no harm, because each one is
  /// repeated until it is answered.
  std::vector<Letter> takeOutbox();
  /// Takes no more work. The work in progress is delivered or handed back within drain_s.
  void interrupt(Time now);

  /// Returns the kernels that the scheduler asked for, one of SessionOptions::runs. Empty if it has
  /// not asked.
  const std::string& wantedKernels() const { return wanted_kernels_; }
  /// Returns ExitCode::interrupted if interrupt() was called and the build is not complete,
  /// otherwise ExitCode::done.
  ExitCode exitCode() const;
  /// Returns the number of results that no scheduler has acknowledged.
  std::size_t unacknowledged() const { return unacknowledged_.size(); }

 private:
  wire::Message& send(std::string payload = "");
  void sayHello(Time now);
  void requestJobs(std::uint32_t credit, bool afresh, Time now);
  void handleWelcome(const wire::Welcome& welcome, Time now);
  void handleUseKernels(const std::string& family);
  void handleProblem(const wire::ProblemReply& reply, const std::string& payload, Time now);
  void askForProblem(Time now);
  void askForStart(const wire::Job& job, Time now);
  void handleJob(const wire::Job& job, Time now);
  void handleFields(const wire::FieldsReply& reply, const std::string& payload, Time now);
  void handleHeartbeat(const wire::HeartbeatReply& reply, Time now);
  void deliverFinished(Time now);
  void deliver(const FinishedTarget& finished, Time now);
  void deliverAgain(Time now);
  void introduceAgain(Time now);
  void beat(Time now);
  void askAgain(bool solving, Time now);
  void forgetWork();
  void drain();
  Next sayGoodbye(const char* reason);
  void forgiveOwnGap(Time now);
  bool solverHangs(Time now);
  bool isIdleForLong(Time now);
  void startReadyJobs();
  std::shared_ptr<const NodalFields> cached(const ContentId& id);
  void remember(const ContentId& id, const std::string& payload);

  Mailbox& mailbox_;
  const SessionOptions options_;
  std::vector<Letter> outbox_;

  std::string epoch_;  ///< of the scheduler; empty before Welcome
  ContentId build_;
  std::shared_ptr<const Problem> problem_;
  std::chrono::milliseconds heartbeat_{1000};
  Time last_turn_, last_heard_, last_connected_;
  Time last_sent_hello_, last_beat_, last_delivered_, last_asked_;
  std::optional<Time> interrupted_at_;
  std::optional<Time> idle_since_;
  std::string wanted_kernels_;
  bool draining_ = false;  ///< no more jobs are requested
  bool finished_ = false;  ///< Drain announced that the build is complete

  std::uint64_t begun_ = 0;  ///< Progress::begun at the last check
  Time begun_at_;

  std::deque<wire::Job> waiting_;  ///< jobs whose start configuration is missing
  std::map<ResultKey, FinishedTarget> unacknowledged_;
  /// Cached start configurations of this problem, the least recently used one last.
  std::list<std::pair<ContentId, std::shared_ptr<const NodalFields>>> cache_;
};

}  // namespace palpate
