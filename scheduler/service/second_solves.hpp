#pragma once

#include "scheduler/service/workers.hpp"

namespace palpate {

/// Results that other workers solve again. Decides which results, when, by which workers, and
/// handles the outcome. Plans do not wait for these checks; the end of the build does. One thread;
/// `state` and `workers` must outlive it.
class SecondSolves {
 public:
  using Time = ServiceState::Time;
  SecondSolves(ServiceState& state, Workers& workers);

  /// Decides whether the first result of a transition is solved again. Call once per transition.
  bool pick(const ResultKey& key, const Outcome& outcome);
  /// Remembers, also across runs, that a result is solved again once it is recorded.
  void note(const ResultKey& key, bool disputed);
  /// Opens the checks of recorded results for which there is room.
  void openDue();
  /// Call when everything is solved. Drops checks of results that no plan asked for in the end, and
  /// all undisputed ones if no second machine ever came. Damaged results keep their check: they are
  /// found before the seal and checked when they are computed again.
  void forgetUnneeded();
  /// Number of checks that are open or still to be opened.
  std::size_t left() const { return checks_.openCount() + due_.size(); }

  /// Handles a second result of a recorded transition. It was asked for as a check, its
  /// acknowledgement was lost, or a worker taken for dead finished after all. Returns true if a
  /// check ended with nobody found wrong.
  bool compare(Worker& worker, const wire::Result& first, const wire::Result& second);
  /// Counts a second result of a transition and reports it if it differs. Returns true if it is the
  /// same.
  bool isSame(const Worker& worker, const wire::Result& first, const wire::Result& second);
  /// Excludes a worker that gave two different results of one transition; no other opinion is
  /// needed.
  void contradict(const Worker& worker, const wire::Result& result);

  /// Returns, for each waiting check, how independent the next worker must be.
  std::map<ResultKey, Apart> wanted() const;
  bool mayTake(const Worker& worker, const ResultKey& key, Apart wanted) const;
  const SpotChecks& checks() const { return checks_; }
  bool isChecked(const ResultKey& key) const { return checks_.isOpen(key) || due_.contains(key); }

  /// Notes how long only checks have been left. After checks_wait, overdue checks go to other
  /// workers; after worker_lost, no worker is expected for the waiting ones.
  void watch();
  /// Gives up the checks that no worker can do. Returns true if there were any.
  bool giveUp();
  /// True if no check waits, or if no worker is expected for the waiting ones.
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
  std::optional<Time> only_these_left_;  ///< time from which on only checks were left
  bool hopeless_ = false;                ///< only checks have been left for worker_lost
};

}  // namespace palpate
