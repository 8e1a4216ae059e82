#pragma once

#include "scheduler/service/workers.hpp"

namespace palpate {

/// Decides which results are solved again, when, and by which other workers, and handles the
/// outcome of these checks. Plans do not wait for the checks, but the build is complete only after
/// them. One thread; `state` and `workers` must outlive this object.
class SecondSolves {
 public:
  using Time = ServiceState::Time;
  SecondSolves(ServiceState& state, Workers& workers);

  /// Decides whether the first result of a transition is to be solved again. Call once per
  /// transition.
  bool pick(const ResultKey& key, const Outcome& outcome);
  /// Stores, also for later runs, that a result is to be solved again once it is recorded.
  void note(const ResultKey& key, bool disputed);
  /// Opens the checks that note() stored, if their results are recorded and there is room.
  void openDue();
  /// Call when all plans are complete. Drops the checks of results that no plan asked for, and all
  /// undisputed checks if no second machine ever joined. A damaged result keeps its check in the
  /// tables: the damage is found before the dataset is written, and the result is checked after it
  /// has been computed again.
  void forgetUnneeded();
  /// Number of checks that are open or are still to be opened.
  std::size_t left() const { return checks_.openCount() + due_.size(); }

  /// Handles a second result of a recorded transition. The result may be the answer to a check, a
  /// repetition of a result whose acknowledgement was lost, or the late result of a worker that was
  /// believed dead. Returns true if it ended a check in which no worker was wrong.
  bool compare(Worker& worker, const wire::Result& first, const wire::Result& second);
  /// Counts a second result of a transition, and reports it if it differs from the first. Returns
  /// true if both are the same.
  bool isSame(const Worker& worker, const wire::Result& first, const wire::Result& second);
  /// Excludes a worker that gave two different results of one transition, which proves an error.
  void contradict(const Worker& worker, const wire::Result& result);

  /// Returns, for each waiting check, how independent the next worker must be.
  std::map<ResultKey, Apart> wanted() const;
  bool mayTake(const Worker& worker, const ResultKey& key, Apart wanted) const;
  const SpotChecks& checks() const { return checks_; }
  bool isChecked(const ResultKey& key) const { return checks_.isOpen(key) || due_.contains(key); }

  /// Call in every turn. Measures how long only checks have been left. Once this time exceeds
  /// checks_wait, overdue checks go to other workers. Once it exceeds worker_lost, no worker is
  /// expected to come for the waiting checks.
  void watch();
  /// Gives up the checks that no worker can do. Returns true if any was given up.
  bool giveUp();
  /// True if no check waits, or if no worker is expected to come for the waiting checks.
  bool stuck() const { return workers_.leases.waitingChecks().empty() || hopeless_; }
  void forgiveGap(std::chrono::nanoseconds gap) {
    if (only_these_left_) *only_these_left_ += gap;
  }

 private:
  bool open(const ResultKey& key, bool disputed);
  bool isRecordedInPlan(const ResultKey& key) const;
  void differs(const Worker& worker, const wire::Result& first, const wire::Result& second);
  void findLiars(const SpotChecks::Verdict& verdict, const std::string& reason);
  bool othersMayCome() const;
  bool isHopeless(const ResultKey& key, Apart wanted) const;

  ServiceState& state_;
  Workers& workers_;
  SpotChecks checks_;
  /// Checks to be opened once their result is recorded and there is room. The value is true if the
  /// result is disputed.
  std::map<ResultKey, bool> due_;
  /// since this time only checks have been left; none if other work is left
  std::optional<Time> only_these_left_;
  bool hopeless_ = false;  ///< only checks have been left for longer than worker_lost
};

}  // namespace palpate
