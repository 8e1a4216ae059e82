#pragma once

#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "scheduler/plan/space_plan.hpp"
#include "scheduler/service/spot_checks.hpp"
#include "tests/simulation/liar.hpp"
#include "tests/simulation/scenario.hpp"

namespace palpate::simulation {

/// Thrown if the service breaks a promise. The message names the promise.
class Broken : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The headers of the records in a state directory. Throws Broken if one cannot be read.
std::vector<wire::Result> recordedIn(const std::filesystem::path& directory);

/// The results and the lying workers of a build, recorded independently of the scheduler.
struct Ledger {
  std::set<ResultKey> acknowledged;
  /// Results whose records were damaged by an accident; they may be computed again.
  std::set<ResultKey> spoiled;
  /// Results of detected liars that must still be computed again.
  std::set<ResultKey> of_liars;

  Lies lies;
  std::map<std::string, std::string> host_of;  ///< host of each peer
  /// The tables were damaged or lost in an accident and may claim anything about the past.
  bool tables_hurt = false;
  /// Exclusions that the tables contain, unless the tables were damaged.
  std::vector<KeptOut> kept_out;
  /// Excluded workers whose results were dropped: none of their results may be recorded any more.
  std::vector<KeptOut> cleaned_of;
  /// Lies in the latest sealed dataset.
  FalseResults sealed_lies;
  /// Whether a peer's latest result of a transition was a lie.
  std::map<std::pair<std::string, ResultKey>, bool> delivered;
  /// Transitions with an acknowledged honest result: a recorded lie about one of them must be
  /// detected.
  std::set<ResultKey> honestly_answered;
  std::size_t lies_heard = 0, verdicts = 0;

  bool mayBeLost(const ResultKey& key) const {
    return spoiled.contains(key) || of_liars.contains(key);
  }
  bool isKeptOut(const std::string& peer) const;
  /// Notes that these exclusions are on disk in the tables.
  void noteKeptOut(const std::vector<KeptOut>& liars);
  void noteDelivery(const std::string& peer, const wire::Result& result);
  void noteAcknowledged(const std::string& peer, const ResultKey& key);
  /// Throws Broken if an honest worker is among the excluded ones.
  void noteVerdict(const std::vector<KeptOut>& liars, const std::filesystem::path& state);
  /// Notes the undetected lies among the records that enter the plans of a dataset about to be
  /// sealed. Throws Broken if another result contradicts one of them.
  void noteSealed(const std::filesystem::path& state, const std::vector<SpacePlan>& plans);
  void hurtTables();
  /// Throws Broken if these are not the expected records.
  void checkRecorded(const std::vector<wire::Result>& recorded) const;
};

}  // namespace palpate::simulation
