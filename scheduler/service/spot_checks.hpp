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
  /// Share of all results that are solved again, whoever gave them. Up to a quarter of it goes to
  /// failures and up to a quarter to odd results; the rest is drawn by lot. 0: no checks.
  double share = 0.01;
  /// Number of failures, and of odd results, that may be solved again even beyond their quarter: a
  /// small build has few results, and one of them may be wrong.
  std::int64_t suspects_at_least = 8;
  /// Limit on open checks: new work goes first.
  std::size_t most_open = 64;
  /// Key that is trusted not to lie on purpose: the scheduler's own.
  std::optional<PublicKey> trusted_key = std::nullopt;
};

/// The finding of one worker for a transition. Equal bits have equal digests.
struct Opinion {
  wire::Provenance giver;
  std::string digest;
};
/// Returns the opinion that a result expresses. `giver` is the worker that delivered it.
Opinion opinionOf(const wire::Result& result, const wire::Provenance& giver);

/// Independence of a worker from those that found a result, the most independent last. A machine is
/// a key and a host. A worker only claims its host, but proves its key.
enum class Apart : std::uint8_t { same_process, same_machine, other_machine, other_key };

/// The keys and machines of some workers.
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
/// Two or more workers that agree are right, and all that differ are wrong, if
/// - the workers that agree have two keys, or one of them has the trusted key; or
/// - no worker with another key differs.
///
/// Numbers of workers decide nothing, because the owner of a key can run any number of them. Until
/// one of the conditions holds, more workers are asked.
///
/// Knows nothing of messages, plans or time. One thread.
class SpotChecks {
 public:
  /// Without `secret` nobody can predict which results are checked.
  SpotChecks(const SpotCheckSettings& settings, std::string secret);

  /// Features of a result that make a check likely.
  struct Look {
    bool failed = false;
    double oddness = 0;  ///< of an equilibrium: oddnessBeside() its parent's
  };
  /// Decides whether a result is solved again. Call once per result.
  bool pick(const ResultKey& key, const Look& look);
  /// True if another check may be opened.
  bool hasRoom() const { return open_.size() < settings_.most_open; }

  /// How a recorded result was solved. Its point may have another result by now.
  struct Start {
    std::string id;                      ///< wire::Job.start_id
    std::optional<ResultKey> solved_by;  ///< recorded result with its fields; none: rest state
    std::uint32_t steps = 0;             ///< wire::Target.steps
  };
  /// Opens a check with the recorded result as its first opinion. The check must not be open.
  /// `disputed`: a worker that is no longer known found a different result.
  void open(const ResultKey& key, Opinion first, Start start, bool disputed = false);
  const Start& startOf(const ResultKey& key) const { return open_.at(key).start; }
  /// Returns the recorded result with the fields of this start, if an open check has it; else none.
  std::optional<ResultKey> solverOfStart(std::string_view id) const;
  bool isOpen(const ResultKey& key) const { return open_.contains(key); }
  /// True if two opinions differ.
  bool isDisputed(const ResultKey& key) const { return open_.at(key).disputed; }
  std::size_t openCount() const { return open_.size(); }
  std::size_t disputedCount() const;

  /// Returns how independent a worker is of all that gave an opinion; same_process if it gave one
  /// itself.
  Apart apart(const ResultKey& key, const wire::Provenance& worker) const;
  /// True if a machine of the crowd gave no opinion yet.
  bool hasOtherMachine(const ResultKey& key, const Crowd& crowd) const;
  /// Returns how independent the next worker must be: with another key if one is at work, else on
  /// another machine. If no other machine may come either, another process settles a dispute.
  Apart wanted(const ResultKey& key, const Crowd& at_work, const Crowd& may_come) const;
  /// True if the worker of this opinion gave a different one before.
  bool contradicts(const ResultKey& key, const Opinion& opinion) const;

  /// The workers that are right or wrong. `wrong` is empty if all agreed.
  struct Verdict {
    std::vector<wire::Provenance> right, wrong;
  };
  /// Adds an opinion to an open check, by a worker that gave none yet. Returns the verdict and
  /// closes the check; none if the check is disputed.
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
  std::vector<double> oddness_;  ///< of the latest results, as a ring buffer
  std::size_t next_ = 0;         ///< next entry to overwrite
  double odd_from_;              ///< an eighth of the share of results is odder
};

/// Returns the exclusions that a verdict adds to those of `before`.
///
/// - The process alone, if another one on its machine was right. The machine, if none was right or
///   if two processes of it are excluded already.
/// - The key, if two other machines with it are excluded already and no worker with it was right.
/// - The key in any case, the fifth time: its owner may pretend to be any number of machines.
/// - Never the trusted key.
///
/// `reason` is human-readable.
std::vector<KeptOut> keptOutBy(const SpotChecks::Verdict& verdict,
                               const std::vector<KeptOut>& before, const std::string& reason,
                               const std::optional<PublicKey>& trusted_key = std::nullopt);

}  // namespace palpate
