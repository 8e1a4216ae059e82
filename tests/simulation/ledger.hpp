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

/// What the service must never do was done. The message says what.
class Broken : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The headers of what is recorded in a state directory. Broken when one cannot be read.
std::vector<wire::Result> recordedIn(const std::filesystem::path& directory);

/// What the outside world knows of a build, whatever became of the scheduler: of its results, and
/// of workers that lie.
struct Ledger {
  std::set<ResultKey> acknowledged;
  /// Their records were damaged by an accident: they may be computed again.
  std::set<ResultKey> spoiled;
  /// Given by somebody who was found out, and to be computed again: until they are.
  std::set<ResultKey> of_liars;

  Lies lies;
  std::map<std::string, std::string> host_of;  ///< of peers
  /// The tables were damaged or lost by an accident, and may claim anything of the past.
  bool tables_hurt = false;
  /// The tables know that these are kept out, as long as they are not hurt.
  std::vector<KeptOut> kept_out;
  /// What they gave was dropped: nobody who was kept out then may have a result recorded.
  std::vector<KeptOut> cleaned_of;
  /// Among what was sealed last.
  FalseResults sealed_lies;
  /// Whether a peer's latest result of a transition was a lie.
  std::map<std::pair<std::string, ResultKey>, bool> delivered;
  /// An honest result of these was acknowledged: whatever is recorded, nobody can miss a lie.
  std::set<ResultKey> honestly_answered;
  std::size_t lies_heard = 0, verdicts = 0;

  bool mayBeLost(const ResultKey& key) const {
    return spoiled.contains(key) || of_liars.contains(key);
  }
  bool isKeptOut(const std::string& peer) const;
  /// The tables have them on disk.
  void noteKeptOut(const std::vector<KeptOut>& liars);
  void noteDelivery(const std::string& peer, const wire::Result& result);
  void noteAcknowledged(const std::string& peer, const ResultKey& key);
  /// Broken when somebody honest is among them.
  void noteVerdict(const std::vector<KeptOut>& liars, const std::filesystem::path& state);
  /// Of what is recorded, what is wrong and rests in the plans of a dataset that is about to be
  /// sealed. Broken when there was another result that contradicts it.
  void noteSealed(const std::filesystem::path& state, const std::vector<SpacePlan>& plans);
  void hurtTables();
  /// Broken when these are not what is to be recorded.
  void checkRecorded(const std::vector<wire::Result>& recorded) const;
};

}  // namespace palpate::simulation
