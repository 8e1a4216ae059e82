#pragma once

#include "scheduler/service/handouts.hpp"
#include "scheduler/service/result_check.hpp"

namespace palpate {

/// Records results in the plans, beginning with those of earlier runs. A new result waits in
/// ServiceState::group until commit() makes the group durable, and is then acknowledged
/// (docs/internals/state.md). One thread; the references must outlive this object.
class Intake {
 public:
  /// Takes over the plans with the results of earlier runs, and queues the transitions whose
  /// results are missing.
  Intake(ServiceState& state, Workers& workers, SecondSolves& seconds, Handouts& handouts);

  /// Handles a received result. Moves the contents to be recorded out of the message. Returns true
  /// if the result ended a check in which no worker was wrong (SecondSolves::compare).
  bool take(Worker& worker, Incoming& incoming);
  /// True if the group has reached its size limit.
  bool isFull() const;
  /// True if the group has waited long enough, or if a worker waits for work. `all_read` is true if
  /// no received message is left unread.
  bool isDue(bool all_read);
  /// Time at which the group becomes due if all messages are read by then.
  ServiceState::Time deadline() const;
  /// Makes the group durable, acknowledges its results, and moves the plans on: their next
  /// transitions may start from these results. Throws like JobStore; no result of the group is then
  /// acknowledged.
  void commit();

  // Number of results recorded in this run, and number of equilibria among them.
  std::int64_t recorded() const { return recorded_; }
  std::int64_t converged() const { return converged_; }

 private:
  void takeFirst(Worker& worker, const Transition& transition, Incoming& incoming, Outcome outcome);
  void takeAgain(const Worker& worker, ResultGroup::Member& waiting, const wire::Result& message);
  bool takeRecorded(Worker& worker, const wire::Result& message);
  void refuseUnwanted(const Worker& worker, const wire::Result& result);
  void goOn(const Settled& settled);

  ServiceState& state_;
  Workers& workers_;
  SecondSolves& seconds_;
  Handouts& handouts_;
  ResultCheck check_;
  UnclaimedResults unclaimed_;  ///< recorded, but no plan has asked for them yet (Replay)
  std::int64_t recorded_ = 0, converged_ = 0;
};

}  // namespace palpate
