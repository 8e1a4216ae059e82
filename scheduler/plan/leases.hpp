#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/space/result_key.hpp"

namespace palpate {

/// Transitions on their way to one worker: all from one start, so of one space and one parent, and
/// never none.
struct Handout {
  std::uint64_t job = 0;
  std::vector<ResultKey> targets;
};

/// A job carries at most as many targets as a point has neighbours.
inline constexpr std::size_t max_targets_per_job = 26;

/// A transition in whose hand-outs this many workers died is handed out alone, so that the next
/// death names it.
inline constexpr int losses_before_alone = 2;

/// A transition that was being solved when this many workers died is set aside. Five, because
/// workers also die for reasons that have nothing to do with what they solve.
inline constexpr int deaths_before_aside = 5;

/// What is known of a transition from workers that ended while they had it. It outlives a run of
/// the scheduler.
struct Losses {
  std::uint32_t attempts = 0;  ///< hand-outs so far
  int suspected = 0;           ///< workers that ended with it next in order, or named
  int deaths = 0;              ///< those that it is known to have ended
  auto operator<=>(const Losses&) const = default;
};

/// Ready transitions and who is solving them. A transition is waiting, then leased to one worker,
/// then finished; a lost worker's leases wait again. One that workers
/// died on is set aside: it is handed out no more until retry(), but a result of it is still
/// welcome. Grouping into jobs depends on timing; results must not.
///
/// One that is finished can be asked for again, as a check, which not every worker may take.
///
/// Workers are named by any string. One thread at a time.
class Leases {
 public:
  /// Job numbers start after `first_job`, so that those of an earlier run of the scheduler are not
  /// taken for ours.
  explicit Leases(std::uint64_t first_job = 0) : last_job_(first_job) {}

  /// What waits of a space of a higher priority is handed out first; 0 as long as nobody said so.
  void setPriority(std::uint32_t space, std::int32_t priority);

  /// A transition became ready, with what earlier runs know of it. It must not be known already.
  void add(const ResultKey& key, const Losses& before = {});
  /// The next job for `worker`: targets around one start, of the highest priority, nearest to the
  /// origin first, and few enough that `workers` workers all get some, and no more than `most`.
  /// Nothing when nothing waits.
  std::optional<Handout> handOut(const std::string& worker, std::size_t workers,
                                 std::size_t most = max_targets_per_job);
  /// The transition has an outcome, whoever found it.
  void finish(const ResultKey& key);

  /// A transition that is finished is to be solved once more. It must not be a check already;
  /// finish() ends it.
  void addCheck(const ResultKey& key);
  /// A job of one check that waits and that `worker` `may` take; nothing when there is none.
  using May = std::function<bool(const ResultKey&)>;
  std::optional<Handout> handOutCheck(const std::string& worker, const May& may);
  const std::set<ResultKey>& waitingChecks() const { return waiting_checks_; }

  /// Ends the leases of a worker, which blames nothing; they wait again.
  void giveBack(const std::string& worker);
  /// What a worker holds that it would come to last; nothing when it holds nothing.
  struct Last {
    std::uint32_t attempts = 0;  ///< how often it was handed out
    bool is_check = false;
  };
  std::optional<Last> lastOf(const std::string& worker) const;
  /// Nothing waits but checks, and nobody solves anything else.
  bool onlyChecksLeft() const { return waiting_count_ == 0 && leased_count_ == leased_checks_; }
  /// Ends that lease alone.
  void giveBackLast(const std::string& worker);
  /// What a worker that ends now would be blamed on: the target it was `solving`, when that is
  /// known, and the next in order.
  struct Suspects {
    std::optional<ResultKey> named, next;
    bool alone = false;  ///< `next` was handed out by itself
  };
  Suspects suspectsOf(const std::string& worker, std::optional<ResultKey> solving) const;
  /// The process of a worker ended with these in its hands, which it holds no more. Returns those
  /// that are still open, with what is known of them now.
  std::vector<std::pair<ResultKey, Losses>> blame(const Suspects& suspects);
  /// Only what is set aside, or checks, is left: nothing waits, and nobody solves.
  bool stuck() const { return !entries_.empty() && waiting_count_ == 0 && leased_count_ == 0; }
  /// Those that are set aside, in order.
  std::vector<ResultKey> aside() const;
  /// They wait again, and nothing is held against any transition.
  void retry();

  std::size_t waiting() const { return waiting_count_; }
  /// Everything that was added is finished.
  bool empty() const { return entries_.empty(); }
  /// Job -> open transitions, in the order in which they are to be solved; never without one.
  using Jobs = std::map<std::uint64_t, std::vector<ResultKey>>;
  /// The jobs that are with this worker.
  const Jobs& jobsOf(const std::string& worker) const;
  /// The number of targets in them. Costs no walk: it is asked of every worker, again and again.
  std::size_t leasedTo(const std::string& worker) const;
  /// The open transitions of that job of that worker, all of one space; empty when there are none.
  std::vector<ResultKey> openOf(const std::string& worker, std::uint64_t job) const;

 private:
  struct Entry {
    Losses losses;
    std::string worker;  ///< empty: not leased
    std::uint64_t job = 0;
    bool is_check = false;
  };
  /// The origin first: what lies near it makes most others ready.
  struct NearestFirst {
    bool operator()(const LatticePoint& a, const LatticePoint& b) const {
      return std::pair(squaredNorm(a), a) < std::pair(squaredNorm(b), b);
    }
  };
  /// In the order of handing out.
  struct Start {
    std::int32_t below_highest = 0;  ///< less its space's priority
    std::int64_t distance = 0;       ///< of the parent from the origin, squared
    LatticePoint parent = {};
    std::uint32_t space = 0;
    auto operator<=>(const Start&) const = default;
  };

  /// What is with one worker.
  struct Held {
    Jobs jobs;
    std::size_t targets = 0;  ///< in them
  };

  static bool isAside(const Entry& entry) {
    return entry.worker.empty() && entry.losses.deaths >= deaths_before_aside;
  }
  Start startOf(std::uint32_t space, const LatticePoint& parent) const;
  void putBack(const ResultKey& key, Entry& entry);
  void lease(const ResultKey& key, const std::string& worker, std::uint64_t job);
  void takeFromWaiting(const ResultKey& key);
  void noteEnd(Held& held, const Entry& entry);
  Jobs endLeases(const std::string& worker);

  std::map<ResultKey, Entry> entries_;
  std::map<Start, std::set<LatticePoint, NearestFirst>> waiting_;
  std::map<std::uint32_t, std::int32_t> priorities_;  ///< by space; of those that have one
  std::set<ResultKey> waiting_checks_;
  std::unordered_map<std::string, Held> by_worker_;
  std::size_t waiting_count_ = 0;
  std::size_t leased_count_ = 0, leased_checks_ = 0;  ///< of all workers; checks are in both
  std::uint64_t last_job_;
};

}  // namespace palpate
