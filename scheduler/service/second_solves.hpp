#pragma once

#include "scheduler/service/workers.hpp"

namespace palpate {

/// Recorded results that other workers solve again: which, when that begins, who may be asked, and
/// what follows from what they find. Plans do not wait for it, only the end of the build does. One
/// thread; `state` and `workers` must outlive it.
class SecondSolves {
 public:
  using Time = ServiceState::Time;
  SecondSolves(ServiceState& state, Workers& workers);

  /// Whether the first result of a transition is to be solved again. To be asked once of each.
  bool pick(const ResultKey& key, const Outcome& outcome);
  /// Whatever happens from now on, it is solved again once it is recorded.
  void note(const ResultKey& key, bool disputed);
  /// Begins those that are recorded and for which there is room.
  void openDue();
  /// When all is solved: drops those of results that no plan asked for in the end, and all of them
  /// where no second machine ever came. Damaged results are found before the seal, and checked when
  /// they are computed again.
  void forgetUnneeded();
  /// So many are open, or to be opened.
  std::size_t left() const { return checks_.openCount() + due_.size(); }

  /// A second result of what is recorded: because it was asked for as a check, or its
  /// acknowledgement was lost, or a worker taken for dead finished after all. Whether a check came
  /// to its end, and nobody lied.
  bool compare(Worker& worker, const wire::Result& first, const wire::Result& second);
  /// Counts a result of a transition that has one, and tells when it is another. Whether it is the
  /// same.
  bool isSame(const Worker& worker, const wire::Result& first, const wire::Result& second);
  /// Who gives two results of one transition needs no others to be found wrong.
  void contradict(const Worker& worker, const wire::Result& result);

  /// How independent the next worker has to be for each that waits.
  std::map<ResultKey, Apart> wanted() const;
  bool mayTake(const Worker& worker, const ResultKey& key, Apart wanted) const;
  const SpotChecks& checks() const { return checks_; }
  bool isChecked(const ResultKey& key) const { return checks_.isOpen(key) || due_.contains(key); }

  /// Notes since when the build is done but for these. Another machine may be missing, or workers
  /// do not ask for work, or do not do what they were given, which others get then.
  void watch();
  /// Gives up those that nobody can do. Returns whether there were any.
  bool giveUp();
  /// None waits, or nobody can be expected who could do those that wait.
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
  /// To be opened, as soon as they are recorded and there is room; whether they are disputed.
  std::map<ResultKey, bool> due_;
  std::optional<Time> only_these_left_;  ///< since then
  bool hopeless_ = false;                ///< nobody came who could do them
};

}  // namespace palpate
