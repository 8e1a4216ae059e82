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
  /// Share of all results that are solved again, by whomever they were given: a quarter of it may
  /// go to failures, a quarter to results that look odd, and what these leave goes by lot. 0: none.
  double share = 0.01;
  /// Failures, and odd results, that are solved again even if that is more than their quarter: a
  /// small build has few results, and one of them may be wrong.
  std::int64_t suspects_at_least = 8;
  /// More at once are not begun: work goes first.
  std::size_t most_open = 64;
  /// Key under which nobody lies on purpose: the scheduler's own.
  std::optional<PublicKey> trusted_key = std::nullopt;
};

/// What one worker found for a transition: two that found the same bits have the same digest.
struct Opinion {
  wire::Provenance giver;
  std::string digest;
};
/// The one that a result is; `giver` is told by those who took it.
Opinion opinionOf(const wire::Result& result, const wire::Provenance& giver);

/// How independent a worker is of those who found a result, the most independent last. A machine is
/// a key and a host: a host is a worker's word, a key is proved.
enum class Apart : std::uint8_t { same_process, same_machine, other_machine, other_key };

/// The keys and the machines of some workers.
struct Crowd {
  std::set<std::string> keys;
  std::set<std::pair<std::string, std::string>> machines;  ///< key and host

  void add(const std::string& key, const std::string& host) {
    keys.insert(key);
    machines.emplace(key, host);
  }
};

/// Which results are solved again by other workers, and what these found. Two that agree are right
/// and whoever differs from them is wrong, where they have two keys, or one that is trusted, or
/// where nobody with another key differs: whoever has a key can be as many workers as he likes. As
/// long as that decides nothing, others are asked.
///
/// Knows nothing of messages, plans or time. One thread.
class SpotChecks {
 public:
  /// `secret`: who does not know it cannot tell which results are checked.
  SpotChecks(const SpotCheckSettings& settings, std::string secret);

  /// How a result looks.
  struct Look {
    bool failed = false;
    double oddness = 0;  ///< of an equilibrium: oddnessBeside what it was reached from
  };
  /// Whether a result is solved again. To be asked once of every result.
  bool pick(const ResultKey& key, const Look& look);
  /// There is room for one more.
  bool hasRoom() const { return open_.size() < settings_.most_open; }

  /// How a recorded result was solved, which its point may not tell any more.
  struct Start {
    std::string id;                      ///< wire::Job.start_id
    std::optional<ResultKey> solved_by;  ///< whose recorded fields have it; nothing: the rest state
    std::uint32_t steps = 0;             ///< wire::Target.steps
  };
  /// Begins: `first` is what is recorded. It must not be open. `disputed`: somebody, who is not
  /// known any more, found something else.
  void open(const ResultKey& key, Opinion first, Start start, bool disputed = false);
  const Start& startOf(const ResultKey& key) const { return open_.at(key).start; }
  /// Of an open check; nothing when none starts there.
  std::optional<ResultKey> solverOfStart(std::string_view id) const;
  bool isOpen(const ResultKey& key) const { return open_.contains(key); }
  /// Two opinions differ.
  bool isDisputed(const ResultKey& key) const { return open_.at(key).disputed; }
  std::size_t openCount() const { return open_.size(); }
  std::size_t disputedCount() const;

  /// From all who gave an opinion; same_process: it gave one itself.
  Apart apart(const ResultKey& key, const wire::Provenance& worker) const;
  /// Whether a machine of the crowd gave no opinion yet.
  bool hasOtherMachine(const ResultKey& key, const Crowd& crowd) const;
  /// How independent the next worker has to be: of another key if one is at work, else of another
  /// machine. If no other machine may come either, another process settles a dispute.
  Apart wanted(const ResultKey& key, const Crowd& at_work, const Crowd& may_come) const;
  /// It says now what it did not say before.
  bool contradicts(const ResultKey& key, const Opinion& opinion) const;

  /// Who is right and who is wrong. `wrong` is empty when all agreed.
  struct Verdict {
    std::vector<wire::Provenance> right, wrong;
  };
  /// One more opinion of an open check, of a worker that is new to it; what is decided then, and
  /// the check is closed. Nothing: it is disputed.
  std::optional<Verdict> hear(const ResultKey& key, const Opinion& opinion);
  /// Without a verdict.
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
  std::vector<double> oddness_;  ///< of the latest results, in a ring
  std::size_t next_ = 0;         ///< to be overwritten
  double odd_from_;              ///< an eighth of the share of them is odder
};

/// Whom a verdict keeps out, besides `before`: the process alone where another on its machine was
/// right, unless two of it are kept out already, else the machine. The key goes, unless it is the
/// trusted one, where two other machines of it are kept out already and nobody with that key was
/// right; and the fifth time, whoever was right: its owner may be any number of machines. `reason`
/// is for people.
std::vector<KeptOut> keptOutBy(const SpotChecks::Verdict& verdict,
                               const std::vector<KeptOut>& before, const std::string& reason,
                               const std::optional<PublicKey>& trusted_key = std::nullopt);

}  // namespace palpate
