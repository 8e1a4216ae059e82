#pragma once

#include "scheduler/service/handouts.hpp"
#include "scheduler/service/result_check.hpp"

namespace palpate {

/// Takes results to the plans, recorded results of earlier runs first. A new result waits in the
/// group of ServiceState until commit() makes the group durable, and is then acknowledged
/// (docs/state.md). One thread; the references must outlive it.
class Intake {
 public:
  /// Records the known results in the plans and queues the missing ones.
  Intake(ServiceState& state, Workers& workers, SecondSolves& seconds, Handouts& handouts);

  /// Handles a result that came in; the contents to be recorded are moved out of it. Returns true
  /// if a check ended with it (SecondSolves::compare).
  bool take(Worker& worker, Incoming& incoming);
  /// True if the group has reached its size limit.
  bool isFull() const;
  /// True if the group has waited long enough. `all_read`: no unread message is left.
  bool isDue(bool all_read);
  /// Latest time at which the group is due once all messages are read.
  ServiceState::Time deadline() const;
  /// Makes the group durable, acknowledges its results and moves the plans on, since their next
  /// transitions may start from them. Throws like JobStore; nothing of the group is then
  /// acknowledged.
  void commit();

  std::size_t found() const { return state_.store.found(); }  ///< results of earlier runs
  // In this run: all results, and the equilibria among them.
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
