#pragma once

#include "common/wire/connections.hpp"
#include "scheduler/service/people.hpp"

namespace palpate {

/// How it goes on after a turn of a coordinator.
enum class Next : std::uint8_t {
  go_on,
  stop,      ///< somebody asked for it
  complete,  ///< every space is complete and recorded
  stuck,     ///< Coordinator::stuck()
  /// Recorded results are to be computed again: somebody wants failures tried again, or they are
  /// those of Coordinator::liars(). Another Build goes on in the directory (Build::keepOut).
  anew,
};

/// What every message means: takes messages and the time, passes them on to its parts (Workers,
/// Handouts, Intake, SecondSolves, People), says in which order these act, and leaves messages to
/// be sent. No sockets, no clock of its own, one thread.
///
/// A result is acknowledged after ResultGroup::commit (docs/state.md). Only then does the plan move
/// on. Construction replays what is recorded, so a restart goes on where the last run was.
///
/// Some results are solved again by other machines (SpotChecks), as soon as there are two. Plans do
/// not wait for that, only the end of the build does.
///
/// Errors of journal or tables leave as exceptions, and DamagedRecord where a result that is needed
/// cannot be read any more. After one, and after Next::anew, the object must not be used, and
/// nothing was acknowledged that is not on disk.
class Coordinator {
 public:
  using Time = ServiceState::Time;

  /// All references must outlive this object. `problem_bytes` is encodeProblem(problem).
  Coordinator(const Problem& problem, std::string problem_bytes, JobStore& store, Time now,
              const CoordinatorSettings& settings = {});

  /// By value: what it brings may be kept.
  void receive(Incoming incoming, Time now);
  /// A message whose sender may not say it: is told why, and if it was a worker, it is none any
  /// more.
  void refuse(const Incoming& incoming, Time now);
  /// Whatever time brings: commits a group that is due, takes back what silent workers hold, hands
  /// out jobs. Call after every batch of messages and at nextDeadline. `all_read`: no message waits
  /// that would show that a silent worker is not silent. Returns next().
  Next advance(Time now, bool all_read = true);
  /// What the messages so far, and the last turn, lead to.
  Next next() const;
  /// Everything to be sent, in order.
  std::vector<Outgoing> takeOutbox() {
    large_answers_.clear();
    return std::exchange(state_.outbox, {});
  }
  /// advance() has something to do then.
  Time nextDeadline() const;

  /// A message could not be delivered: the peer is gone, or reads nothing.
  void peerUnreachable(const std::string& peer, Time now) {
    state_.now = now;
    workers_.unreachable(peer);
  }
  /// Connections were closed because they cost too much.
  void noteClosed(const Connections::Closed& closed, Time now);
  /// The local process `pid` ended by itself: what it was solving may have killed it.
  void workerProcessEnded(std::uint32_t pid, Time now) {
    state_.now = now;
    workers_.processEnded(pid);
  }

  /// No more hand-outs; workers are told to leave. Commits what is there.
  void stop(Time now);
  bool stopping() const { return state_.stopping; }
  /// Whether nothing is handed out, before it is told to go on: in this run and the next ones.
  /// Workers finish what they hold, and stay.
  void pause(bool paused) { people_.pause(paused); }
  bool paused() const { return state_.paused; }
  /// Every space is complete and recorded.
  bool complete() const { return state_.complete; }
  /// All is recorded but transitions that are set aside, because workers died on them, and disputed
  /// ones for which there is no other worker to ask.
  bool stuck() const {
    return !state_.complete && state_.group.size() == 0 && workers_.leases.stuck() &&
           seconds_.stuck();
  }
  /// Whoever was found to give wrong results: Build::keepOut() comes before another Build.
  const std::vector<KeptOut>& liars() const { return state_.liars; }
  std::size_t asideCount() const { return workers_.leases.aside().size(); }
  /// Whether another worker is asked for what is recorded, or is to be.
  bool isChecked(const ResultKey& key) const { return seconds_.isChecked(key); }
  /// Results that two workers found differently.
  std::size_t disputedCount() const { return seconds_.checks().disputedCount(); }
  /// The dataset can do without workers: they are told to leave.
  void dismiss() {
    state_.dismissed = true;
    workers_.drainAll();
  }
  /// Workers that said hello and neither left nor were lost.
  std::size_t workers() const { return workers_.registry.all().size(); }
  /// No worker said anything for three heartbeats: after Drain they have all left.
  bool deserted(Time now) const { return workers_.deserted(now); }
  /// Results that earlier runs left.
  std::size_t found() const { return intake_.found(); }
  /// Results recorded since construction.
  std::int64_t recorded() const { return intake_.recorded(); }

  /// What people are told (docs/commands.md).
  wire::Status status(Time now) const { return people_.status(now); }
  /// One per active node.
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
  std::map<std::string, int> large_answers_;  ///< in the outbox, by peer
  Time last_turn_;
};

}  // namespace palpate
