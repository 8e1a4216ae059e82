#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/keys/key_pair.hpp"
#include "scheduler/state/job_store.hpp"

namespace palpate {

struct SpotCheckSettings {
  /// Fraction of all results that are solved again, whichever worker gave them. Up to a quarter of
  /// this fraction goes to failures, and up to a quarter to odd results (oddnessBeside); the rest
  /// is drawn by lot. If `share` is 0, no result is picked.
  double share = 0.01;
  /// Up to this many failures, and this many odd results, are solved again even if they exceed a
  /// quarter of `share`, which in a small build is less than one result.
  std::int64_t suspects_at_least = 8;
  /// Limit on the number of open checks, so that they do not delay new work.
  std::size_t most_open = 64;
  /// Key that is trusted not to give wrong results on purpose: the scheduler's own.
  std::optional<PublicKey> trusted_key = std::nullopt;
};

/// The result of one worker for a transition, reduced to a digest. Results with equal reproducible
/// bits have equal digests.
struct Opinion {
  wire::Provenance giver;
  std::string digest;
};
/// Returns the opinion of `giver`, the worker that delivered this result.
Opinion opinionOf(const wire::Result& result, const wire::Provenance& giver);

/// How independent a worker is of the workers that found a result; the most independent value comes
/// last. A machine is identified by a key and a host. A worker proves its key, but only claims its
/// host.
enum class Apart : std::uint8_t { same_process, same_machine, other_machine, other_key };

/// The keys and machines of a set of workers.
struct Crowd {
  std::set<std::string> keys;
  std::set<std::pair<std::string, std::string>> machines;  ///< key and host

  void add(const std::string& key, const std::string& host) {
    keys.insert(key);
    machines.emplace(key, host);
  }
};

/// Decides which results other workers solve again, and judges their findings.
///
/// Two or more workers that agree are right, and all others are wrong, if
/// - the workers that agree have two different keys, or one of them has the trusted key; or
/// - no worker that disagrees has a different key.
///
/// The number of workers on each side does not matter, because the owner of a key can run any
/// number of them. Until one of the conditions holds, more workers are asked.
///
/// Knows nothing of messages, plans or time. One thread.
class SpotChecks {
 public:
  /// Without `secret` nobody can predict which results are checked.
  SpotChecks(const SpotCheckSettings& settings, std::string secret);

  /// Features of a result that make a check likely.
  struct Look {
    bool failed = false;
    double oddness = 0;  ///< oddnessBeside() of an equilibrium and its parent
  };
  /// Decides whether a result is solved again. Call once per result.
  bool pick(const ResultKey& key, const Look& look);
  /// True if another check may be opened.
  bool hasRoom() const { return open_.size() < settings_.most_open; }

  /// The start of the solve that gave a recorded result. Its point may have another result by now.
  struct Start {
    std::string id;  ///< wire::Job.start_id
    /// result that holds the fields of the start; nullopt if the start is the rest state
    std::optional<ResultKey> solved_by;
    std::uint32_t steps = 0;  ///< wire::Target.steps
  };
  /// Opens a check with the recorded result as its first opinion. The check must not be open yet.
  /// `disputed` is true if a worker, which is no longer known, found a different result.
  void open(const ResultKey& key, Opinion first, Start start, bool disputed = false);
  const Start& startOf(const ResultKey& key) const { return open_.at(key).start; }
  /// Returns the recorded result that holds the fields of the start `id`; none if no open check has
  /// this start.
  std::optional<ResultKey> solverOfStart(std::string_view id) const;
  bool isOpen(const ResultKey& key) const { return open_.contains(key); }
  /// True if two opinions differ.
  bool isDisputed(const ResultKey& key) const { return open_.at(key).disputed; }
  std::size_t openCount() const { return open_.size(); }
  std::size_t disputedCount() const;

  /// Returns how independent `worker` is of all workers that gave an opinion; same_process if it
  /// gave one itself.
  Apart apart(const ResultKey& key, const wire::Provenance& worker) const;
  /// Returns how independent the next worker must be. It must have another key if `at_work` has a
  /// key without an opinion, else be on another machine. To settle a dispute, another process is
  /// enough if every machine in `may_come` has given an opinion.
  Apart wanted(const ResultKey& key, const Crowd& at_work, const Crowd& may_come) const;
  /// True if the worker that gave this opinion gave a different one before.
  bool contradicts(const ResultKey& key, const Opinion& opinion) const;

  /// The workers judged right and those judged wrong. `wrong` is empty if all agreed.
  struct Verdict {
    std::vector<wire::Provenance> right, wrong;
  };
  /// Adds an opinion to an open check, from a worker that has given none yet. If the check is now
  /// decided, closes it and returns the verdict. Otherwise the check is disputed, and no verdict is
  /// returned.
  std::optional<Verdict> hear(const ResultKey& key, const Opinion& opinion);
  /// Closes a check without a verdict.
  void close(const ResultKey& key) { open_.erase(key); }

 private:
  struct Check {
    std::vector<Opinion> opinions;
    Start start;
    bool disputed = false;
  };
  bool isOdd(double oddness);
  bool isSuspect(const Look& look);
  Crowd giversAmong(const ResultKey& key, const Crowd& crowd) const;
  bool isDecided(const Verdict& verdict) const;

  SpotCheckSettings settings_;
  std::string secret_;
  std::map<ResultKey, Check> open_;
  std::int64_t results_ = 0, odd_picked_ = 0, failed_picked_ = 0;
  std::vector<double> oddness_;  ///< oddness of the latest results, as a ring buffer
  std::size_t next_ = 0;         ///< next entry to overwrite
  /// results with a greater oddness are odd: about settings_.share / 8 of the latest ones
  double odd_from_;
};

/// Returns the exclusions that a verdict adds to the exclusions in `before`. For each worker that
/// was wrong, these rules apply:
///
/// - Only its process is excluded if another process on its machine was right. Its whole machine is
///   excluded if no process there was right, or if two processes there are excluded already.
/// - Its key is excluded if two other machines with the key are excluded already and no worker with
///   the key was right.
/// - Its key is excluded in any case if four exclusions name the key already, because the owner may
///   pretend to have any number of machines.
/// - The trusted key is never excluded.
///
/// `reason` is human-readable.
std::vector<KeptOut> keptOutBy(const SpotChecks::Verdict& verdict,
                               const std::vector<KeptOut>& before, const std::string& reason,
                               const std::optional<PublicKey>& trusted_key = std::nullopt);

}  // namespace palpate
