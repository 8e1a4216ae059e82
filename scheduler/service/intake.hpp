#pragma once

#include "scheduler/service/handouts.hpp"
#include "scheduler/service/result_check.hpp"

namespace palpate {

/// From results, recorded ones of earlier runs first, to the plans. A result waits in the group of
/// ServiceState until commit() makes all of it durable, and is acknowledged then (docs/state.md).
/// One thread; the references must outlive it.
class Intake {
 public:
  /// Puts what is recorded into the plans, and asks for what is missing.
  Intake(ServiceState& state, Workers& workers, SecondSolves& seconds, Handouts& handouts);

  /// A result that came in; what is to be recorded is moved out of it. Returns whether a check
  /// ended with it (SecondSolves::compare).
  bool take(Worker& worker, Incoming& incoming);
  /// The group is as large as it may be.
  bool isFull() const;
  /// The group has waited long enough. `all_read`: nothing more has come.
  bool isDue(bool all_read);
  /// When it is due at the latest, once all is read.
  ServiceState::Time deadline() const;
  /// Makes the group durable, acknowledges it, and moves the plans on: what they ask for next may
  /// rest on it. Errors are those of JobStore, and nothing of the group is acknowledged then.
  void commit();

  std::size_t found() const { return state_.store.found(); }  ///< results of earlier runs
  // Of this run: results, and equilibria among them.
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
  UnclaimedResults unclaimed_;  ///< recorded, and not asked for yet (Replay)
  std::int64_t recorded_ = 0, converged_ = 0;
};

}  // namespace palpate
