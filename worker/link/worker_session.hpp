#pragma once

#include <functional>
#include <list>

#include "common/base/program.hpp"
#include "common/wire/wire.hpp"
#include "worker/link/mailbox.hpp"

namespace palpate {

/// Where a worker goes, what it says of itself, and how patient it is.
struct SessionOptions {
  /// Of the scheduler, as checkEndpoint() wants it.
  std::string endpoint = default_endpoint;
  /// Its own name, 1 to 64 bytes, and those of the workers in whose place it was started because
  /// their processes ended, which the scheduler is told.
  std::string worker_id;
  std::vector<std::string> ended = {};
  std::string host;
  std::uint32_t pid = 0;
  std::string kernel_family;           ///< as arithmetic() names it
  std::vector<std::string> runs = {};  ///< families that it can start itself anew with
  /// The worker ends without any word from the scheduler for this long.
  double give_up_s = 15 * 60;
  /// The worker leaves when it has had nothing to do for this long. 0: never.
  double leave_idle_s = 0;
  /// Once interrupted: how long to wait until the target in work is done and acknowledged.
  double drain_s = 10;
};

/// A worker's side of the protocol (docs/wire.md): says hello, asks for work, fetches start
/// configurations, delivers results and keeps each until it is acknowledged. Whatever happens to
/// the scheduler, it asks again and delivers again.
///
/// Takes messages and the time, and sends what it has to say. No sockets, no clock of its own, one
/// thread; the solver is on the other side of the mailbox.
class WorkerSession {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// Nothing is lost when a message does not arrive: everything is said again until it is answered.
  using Send = std::function<void(wire::Message, std::string_view payload)>;

  /// `mailbox` must outlive it.
  WorkerSession(Mailbox& mailbox, SessionOptions options, Send send, Time now);

  /// Error when the scheduler refuses this worker.
  void receive(const Incoming& incoming, Time now);

  /// What the process around it is to do after advance().
  enum class Next : std::uint8_t {
    go_on,    ///< call advance() again when messages came, the mailbox woke up, or 50 ms passed
    connect,  ///< anew: nothing came for long. Then say connected()
    end,      ///< with exitCode(); a goodbye was sent
    anew,     ///< with wantedKernels(), as the same worker
    killed    ///< the solver hangs: end at once and without a word, as if killed
  };
  /// Whatever time brings, and what the solver finished. Call after every batch of messages.
  /// Error when the scheduler says nothing for give_up_s, and when the solver thread gave up.
  Next advance(Time now);
  void connected(Time now);
  /// No more work is taken: what is in work is delivered or handed back within drain_s.
  void interrupt(Time now);

  /// One of SessionOptions::runs, once the scheduler asked for it; empty before.
  const std::string& wantedKernels() const { return wanted_kernels_; }
  /// done: there is no more work; interrupted otherwise.
  ExitCode exitCode() const;
  /// Results that no scheduler acknowledged yet.
  std::size_t unacknowledged() const { return unacknowledged_.size(); }

 private:
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
  void sayGoodbye(const char* reason);
  void forgiveOwnGap(Time now);
  bool solverHangs(Time now);
  bool isIdleForLong(Time now);
  void startReadyJobs();
  std::shared_ptr<const NodalFields> cached(const ContentId& id);
  void remember(const ContentId& id, const std::string& payload);

  Mailbox& mailbox_;
  const SessionOptions options_;
  const Send send_;

  std::string epoch_;  ///< of the scheduler; empty before Welcome
  ContentId build_;
  std::shared_ptr<const Problem> problem_;
  std::chrono::milliseconds heartbeat_{1000};
  Time last_turn_, last_heard_, last_connected_;
  Time last_sent_hello_, last_beat_, last_delivered_, last_asked_;
  std::optional<Time> interrupted_at_;
  std::optional<Time> idle_since_;
  std::string wanted_kernels_;
  bool draining_ = false;  ///< no more jobs are asked for
  bool finished_ = false;  ///< Drain said the build is complete

  std::uint64_t begun_ = 0;  ///< of the mailbox, when it was looked at last
  Time begun_at_;

  std::deque<wire::Job> waiting_;  ///< jobs whose start configuration is not here yet
  std::map<ResultKey, FinishedTarget> unacknowledged_;
  /// Start configurations of this problem, least recently used last.
  std::list<std::pair<ContentId, std::shared_ptr<const NodalFields>>> cache_;
};

}  // namespace palpate
