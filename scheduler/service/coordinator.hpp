#pragma once

#include "common/wire/connections.hpp"
#include "scheduler/service/people.hpp"

namespace palpate {

/// How the scheduler continues after a turn. One turn is one exchange() of messages with all peers
/// (transport.hpp).
enum class Next : std::uint8_t {
  go_on,
  stop,      ///< Coordinator::stop() was called
  complete,  ///< every space is complete and recorded
  stuck,     ///< Coordinator::stuck()
  /// Some recorded results must be computed again, because an operator wants failures tried again,
  /// or because workers in Coordinator::liars() computed them. A new Build continues in the
  /// directory (Build::keepOut).
  anew,
};

/// Handles every message of the scheduler. The caller passes in messages and the time, and takes
/// out the messages to be sent: a coordinator has no sockets and no clock of its own. The work is
/// done by its parts (Workers, Handouts, Intake, SecondSolves, People); the coordinator decides in
/// which order they act. One thread.
///
/// A result is acknowledged, and its plan moves on, only after ResultGroup::commit
/// (docs/internals/state.md). The constructor replays the recorded results, so a restart continues
/// where the last run stopped.
///
/// As soon as there are two machines, some results are solved again by another machine
/// (SpotChecks). Plans do not wait for these checks, but the build is complete only after them.
///
/// Throws if the journal or the tables fail, and DamagedRecord if a result that is needed can no
/// longer be read. After an exception, and after Next::anew, the object must not be used; every
/// acknowledged result is then on disk.
class Coordinator {
 public:
  using Time = ServiceState::Time;

  /// All references must outlive this object. `problem_bytes` is encodeProblem(problem).
  Coordinator(const Problem& problem, std::string problem_bytes, JobStore& store, Time now,
              const CoordinatorSettings& settings = {});

  /// Handles a message. Takes it by value, because its contents may be moved into the records.
  void receive(Incoming incoming, Time now);
  /// Refuses a message that its sender's role does not allow. The sender is told why. If the sender
  /// is a worker, it is removed.
  void refuse(const Incoming& incoming, Time now);
  /// Does the work that is due: commits a group of results, takes back the leases of silent
  /// workers, hands out jobs. Call after every batch of messages and at nextDeadline(). `all_read`
  /// is true if every received message has been read; otherwise no worker is judged to be silent,
  /// because its messages may be unread. Returns next().
  Next advance(Time now, bool all_read = true);
  /// Returns how the scheduler should continue now.
  Next next() const;
  /// Returns the messages to be sent, in order.
  std::vector<Outgoing> takeOutbox() {
    large_answers_.clear();
    return std::exchange(state_.outbox, {});
  }
  /// Time when advance() next has work.
  Time nextDeadline() const;

  /// Call when a message could not be delivered: the peer is gone or does not read.
  void peerUnreachable(const std::string& peer, Time now) {
    state_.now = now;
    workers_.unreachable(peer);
  }
  /// Call with the connections that Connections closed because they exceeded its limits.
  void noteClosed(const Connections::Closed& closed, Time now);

  /// Stops handing out jobs, commits the waiting results and tells workers to leave.
  void stop(Time now);
  bool stopping() const { return state_.stopping; }
  /// Stops or resumes handing out jobs, in this run and the next ones. While paused, workers finish
  /// their leases and stay.
  void pause(bool paused) { people_.pause(paused); }
  bool paused() const { return state_.paused; }
  /// True if every space is complete and recorded.
  bool complete() const { return state_.complete; }
  /// True if only transitions are left that cannot proceed: transitions that are set aside because
  /// workers died on them, and disputed transitions for which there is no further worker.
  bool stuck() const {
    return !state_.complete && state_.group.size() == 0 && workers_.leases.stuck() &&
           seconds_.stuck();
  }
  /// Workers that are to be excluded because they gave wrong results. Pass them to Build::keepOut()
  /// before making another Build.
  const std::vector<KeptOut>& liars() const { return state_.liars; }
  std::size_t asideCount() const { return workers_.leases.aside().size(); }
  /// True if the recorded result is being solved again by another worker, or will be.
  bool isChecked(const ResultKey& key) const { return seconds_.isChecked(key); }
  /// Number of open checks in which two workers found different results.
  std::size_t disputedCount() const { return seconds_.checks().disputedCount(); }
  /// Tells all workers to leave, because nothing is left for them to solve.
  void dismiss() {
    state_.dismissed = true;
    workers_.drainAll();
  }
  /// Number of workers that said hello and neither left nor were lost.
  std::size_t workers() const { return workers_.registry.all().size(); }
  /// True if no worker has sent anything for three heartbeat intervals. Once workers were told to
  /// leave, this means that all are gone.
  bool deserted(Time now) const { return workers_.deserted(now); }
  /// Number of results from earlier runs.
  std::size_t found() const { return state_.store.found(); }
  /// Number of results recorded since construction.
  std::int64_t recorded() const { return intake_.recorded(); }

  /// Returns the status that users see (docs/commands.md).
  wire::Status status(Time now) const { return people_.status(now); }
  /// One plan per active node.
  const std::vector<SpacePlan>& plans() const { return state_.plans; }

 private:
  bool answer(const Incoming& incoming);
  bool readsTooSlowly(const Incoming& incoming);
  void noteOwnGap(Time now);
  void commit();
  void goOn();

  ServiceState state_;
  Workers workers_;
  SecondSolves seconds_;
  Handouts handouts_;
  Intake intake_;
  People people_;
  /// number of large answers that each peer asked for since takeOutbox()
  std::map<std::string, int> large_answers_;
  Time last_turn_;
};

}  // namespace palpate
