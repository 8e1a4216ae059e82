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

/// The transitions (targets) sent to one worker as one job. All have the same start, that is the
/// same space and parent. Never empty.
struct Handout {
  std::uint64_t job = 0;
  std::vector<ResultKey> targets;
};

/// Limit on the number of targets of a job: the number of neighbours of a point.
inline constexpr std::size_t max_targets_per_job = 26;

/// A transition that is suspected in this many deaths of workers is handed out alone, so that the
/// next death identifies it.
inline constexpr int losses_before_alone = 2;

/// A transition is set aside once this many deaths are attributed to it. One death is not enough,
/// because workers also die for reasons unrelated to their work.
inline constexpr int deaths_before_aside = 5;

/// Hand-outs of a transition, and worker deaths in which it is suspected. Kept across restarts.
struct Losses {
  std::uint32_t attempts = 0;  ///< hand-outs so far
  int suspected = 0;  ///< number of worker deaths in which it was a suspect (Leases::Suspects)
  int deaths = 0;     ///< number of worker deaths that are attributed to it
  auto operator<=>(const Losses&) const = default;
};

/// Ready transitions and the workers that solve them.
///
/// A transition first waits, is then leased to one worker, and is finished when its result arrives.
/// The transitions of a lost worker wait again. A transition that killed several workers is set
/// aside: it is not handed out before retry(), but its result is still accepted. The grouping into
/// jobs depends on timing; results must not.
///
/// A finished transition can be solved again as a check, by a worker that the caller allows.
///
/// Workers are identified by arbitrary strings. One thread at a time.
class Leases {
 public:
  /// Job numbers start after `first_job`, so they differ from those of an earlier run of the
  /// scheduler.
  explicit Leases(std::uint64_t first_job = 0) : last_job_(first_job) {}

  /// Sets the priority of a space, 0 by default. Waiting transitions of higher priority are handed
  /// out first.
  void setPriority(std::uint32_t space, std::int32_t priority);

  /// Adds a transition that became ready, with its losses in earlier runs. It must not have been
  /// added before.
  void add(const ResultKey& key, const Losses& before = {});
  /// Leases the next job to `worker`. All its targets have the same start, which is the one nearest
  /// to the origin among the spaces with the highest priority. The job has at most `most` targets,
  /// and few enough that each of `workers` workers gets some. Returns none if nothing waits.
  std::optional<Handout> handOut(const std::string& worker, std::size_t workers,
                                 std::size_t most = max_targets_per_job);
  /// Removes a transition that has an outcome, no matter which worker found it.
  void finish(const ResultKey& key);

  /// Queues a finished transition to be solved again. The transition must not be queued already.
  /// finish() ends the check.
  void addCheck(const ResultKey& key);
  using May = std::function<bool(const ResultKey&)>;
  /// Finds a waiting check that `may` accepts, and leases it to `worker` as a job of its own.
  /// Returns none if `may` accepts no check.
  std::optional<Handout> handOutCheck(const std::string& worker, const May& may);
  const std::set<ResultKey>& waitingChecks() const { return waiting_checks_; }

  /// Ends the leases of a worker without blaming any transition. Its transitions wait again.
  void giveBack(const std::string& worker);
  /// The target that a worker will solve last. lastOf() returns none if the worker holds no target.
  struct Last {
    std::uint32_t attempts = 0;  ///< hand-outs so far
    bool is_check = false;
  };
  std::optional<Last> lastOf(const std::string& worker) const;
  /// True if checks are the only transitions that wait or are being solved.
  bool onlyChecksLeft() const { return waiting_count_ == 0 && leased_count_ == leased_checks_; }
  /// Ends the lease that lastOf() describes. The worker must hold one.
  void giveBackLast(const std::string& worker);
  /// The transitions that would be blamed if a worker died now: the target that it reported as
  /// `solving`, if any, and the next target of its jobs.
  struct Suspects {
    std::optional<ResultKey> named, next;
    bool alone = false;  ///< `next` was handed out alone
  };
  Suspects suspectsOf(const std::string& worker, std::optional<ResultKey> solving) const;
  /// Blames the suspects for the death of a worker. Call after the worker's leases were ended.
  /// Returns the suspects that are still open, with their updated losses.
  std::vector<std::pair<ResultKey, Losses>> blame(const Suspects& suspects);
  /// True if only set-aside transitions and waiting checks are left, and nothing is being solved.
  bool stuck() const { return !entries_.empty() && waiting_count_ == 0 && leased_count_ == 0; }
  /// Returns the set-aside transitions, sorted.
  std::vector<ResultKey> aside() const;
  /// Clears the suspicions and deaths of all transitions; set-aside ones wait again.
  void retry();

  std::size_t waiting() const { return waiting_count_; }
  /// True if everything that was added is finished.
  bool empty() const { return entries_.empty(); }
  /// The open transitions of one worker by job, in the order of solving. No job is empty.
  using Jobs = std::map<std::uint64_t, std::vector<ResultKey>>;
  /// Returns the jobs of a worker.
  const Jobs& jobsOf(const std::string& worker) const;
  /// Returns the number of targets in the jobs of a worker. Takes constant time, because it is
  /// called often for every worker.
  std::size_t leasedTo(const std::string& worker) const;
  /// Returns the open transitions of a worker's job, all of one space; empty if there are none.
  std::vector<ResultKey> openOf(const std::string& worker, std::uint64_t job) const;

 private:
  struct Entry {
    Losses losses;
    std::string worker;  ///< empty if not leased
    std::uint64_t job = 0;
    bool is_check = false;
  };
  /// Orders points by distance from the origin: most transitions depend on points near it.
  struct NearestFirst {
    bool operator()(const LatticePoint& a, const LatticePoint& b) const {
      return std::pair(squaredNorm(a), a) < std::pair(squaredNorm(b), b);
    }
  };
  /// The start of a set of waiting transitions. Sets are handed out in the order of these members.
  struct Start {
    /// minus the priority of the space, so that the highest priority comes first
    std::int32_t below_highest = 0;
    std::int64_t distance = 0;  ///< squared distance of the parent from the origin
    LatticePoint parent = {};
    std::uint32_t space = 0;
    auto operator<=>(const Start&) const = default;
  };

  /// The jobs of one worker.
  struct Held {
    Jobs jobs;
    std::size_t targets = 0;  ///< number of targets in all jobs
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
  std::map<std::uint32_t, std::int32_t> priorities_;  ///< by space; a space without an entry has 0
  std::set<ResultKey> waiting_checks_;
  std::unordered_map<std::string, Held> by_worker_;
  std::size_t waiting_count_ = 0;
  /// number of leases, and number of those that are checks
  std::size_t leased_count_ = 0, leased_checks_ = 0;
  std::uint64_t last_job_;
};

}  // namespace palpate
