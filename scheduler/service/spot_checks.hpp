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
  /// Of all results.
  double share = 0.01;
  /// Of a worker's nth result: this / n, so that one that is broken from the start is found at
  /// once.
  double share_of_first = 0.25;
  /// Of all results, those that look oddest (oddnessBeside).
  double share_of_odd = 0.003;
  /// They, and what they were reached from, are left out beyond this share of all results, or a
  /// few: solving twice costs as much as solving.
  double most_odd = 0.0065;
  std::int64_t odd_at_least = 8;
  /// Failures, as long as they are fewer than this share of all results, or a few: what costs the
  /// dataset a point is not taken from one worker alone.
  double share_of_failed = 0.0025;
  std::int64_t failed_at_least = 8;
  /// More at once are not begun: work goes first.
  std::size_t most_open = 64;
  /// Under which nobody lies on purpose: the scheduler's own.
  std::optional<PublicKey> trusted_key = std::nullopt;

  /// Of all results; 0: none, whatever they look like.
  static SpotCheckSettings ofShare(double share) {
    SpotCheckSettings settings = share > 0 ? SpotCheckSettings{} : none();
    settings.share = share;
    return settings;
  }
  static SpotCheckSettings none() {
    return {.share = 0,
            .share_of_first = 0,
            .share_of_odd = 0,
            .most_odd = 0,
            .odd_at_least = 0,
            .share_of_failed = 0,
            .failed_at_least = 0,
            .most_open = 0};
  }
};

/// What one worker found for a transition: two that found the same bits have the same digest.
struct Opinion {
  wire::Provenance giver;
  std::string digest;
};
/// The one that a result is; `giver` is told by those who took it.
Opinion opinionOf(const wire::Result& result, const wire::Provenance& giver);

/// How far a worker is from all that found a result. Whom a host belongs to is what it says itself,
/// a key is proved.
enum class Apart : std::uint8_t { same_process, same_machine, same_key, other_key };

/// Keys and machines (key and host) of the workers that a check can reckon with.
struct Crowd {
  std::set<std::string> keys;
  std::set<std::pair<std::string, std::string>> machines;
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
  /// Why a result is checked, the `nth` of its worker, from 1. To be asked once of every result.
  enum class Picked : std::uint8_t { no, by_lot, as_failed, as_odd };
  Picked pick(const ResultKey& key, std::int64_t nth, const Look& look);
  /// Whether the result that an odd one was reached from is checked too: it may be what is wrong.
  bool pickStart(const ResultKey& key);
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
  /// How far a worker has to be: as far as one of the crowd may be.
  Apart wanted(const ResultKey& key, const Crowd& crowd) const;
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
  /// Counts one more of `picked`, as long as they are fewer than that share of all results, or
  /// `at_least`.
  bool pickWithin(double share, std::int64_t at_least, std::int64_t& picked) const;
  bool pickOdd() { return pickWithin(settings_.most_odd, settings_.odd_at_least, odd_picked_); }
  bool isDecided(const Verdict& verdict) const;

  SpotCheckSettings settings_;
  std::string secret_;
  std::map<ResultKey, Check> open_;
  std::set<ResultKey> begun_;
  std::int64_t results_ = 0, odd_picked_ = 0, failed_picked_ = 0;
  std::vector<double> oddness_;  ///< of the latest results, in a ring
  std::size_t next_ = 0;         ///< to be overwritten
  double odd_from_;              ///< the share of them that is odder is share_of_odd
};

/// Results were wrong, and those who gave them are to be kept out (JobStore::keepOut); the next
/// Build in the directory computes again what they gave.
class LiarsFound : public Error {
 public:
  explicit LiarsFound(std::vector<KeptOut> liars)
      : Error(ExitCode::failed, liars.front().reason), liars_(std::move(liars)) {}
  const std::vector<KeptOut>& liars() const { return liars_; }

 private:
  std::vector<KeptOut> liars_;
};

/// Whom a verdict keeps out, besides `before`: the process alone where another on its machine was
/// right, unless two of it are kept out already, else the machine; and the key, where two other
/// machines of it are kept out already and nobody with that key was right. `reason` is for people.
std::vector<KeptOut> keptOutBy(const SpotChecks::Verdict& verdict,
                               const std::vector<KeptOut>& before, const std::string& reason);

}  // namespace palpate
