#include "tests/simulation/ledger.hpp"

#include <algorithm>

#include "common/wire/wire.hpp"
#include "scheduler/state/job_store.hpp"
#include "tests/support/scanned_journal.hpp"

namespace palpate::simulation {
namespace {

bool isCovered(const std::vector<KeptOut>& kept_out, const wire::Provenance& who) {
  return std::ranges::any_of(kept_out, [&](const KeptOut& each) { return each.covers(who); });
}

bool isIn(const std::vector<SpacePlan>& plans, const ResultKey& key) {
  const std::optional<Transition> transition = findIn(plans, key);
  return transition && plans[key.space].isRecorded(*transition);
}

}  // namespace

std::vector<wire::Result> recordedIn(const std::filesystem::path& directory) {
  std::vector<wire::Result> results;
  for (const auto& found : test::scanned(JournalReader(directory)).records)
    if (!results.emplace_back().ParseFromString(found.header))
      throw Broken("a record in the journal cannot be read");
  return results;
}

bool Ledger::isKeptOut(const std::string& peer) const {
  const auto host = host_of.find(peer);
  if (host == host_of.end()) return false;
  wire::Provenance who;
  who.set_host(host->second);
  return isCovered(kept_out, who);
}

void Ledger::noteKeptOut(const std::vector<KeptOut>& liars) {
  if (tables_hurt) return;
  for (const KeptOut& liar : liars)
    if (std::ranges::find(kept_out, liar) == kept_out.end()) kept_out.push_back(liar);
}

void Ledger::noteDelivery(const std::string& peer, const wire::Result& result) {
  const bool lie = lies.contain(result);
  lies_heard += lie;
  delivered[{peer, keyOf(result)}] = lie;
}

void Ledger::noteAcknowledged(const std::string& peer, const ResultKey& key) {
  acknowledged.insert(key);
  of_liars.erase(key);
  if (const auto found = delivered.find({peer, key}); found != delivered.end() && !found->second)
    honestly_answered.insert(key);
}

void Ledger::noteVerdict(const std::vector<KeptOut>& liars, const std::filesystem::path& state) {
  ++verdicts;
  for (const KeptOut& liar : liars)
    if (!lies.isLiar(liar.who.host()) || liar.kind == KeptOut::Kind::key)
      throw Broken("an honest worker is kept out: " + liar.reason);
  for (const wire::Result& result : recordedIn(state))
    if (isCovered(liars, result.given_by())) of_liars.insert(keyOf(result));
}

void Ledger::noteSealed(const std::filesystem::path& state, const std::vector<SpacePlan>& plans) {
  sealed_lies.clear();
  for (wire::Result& result : recordedIn(state)) {
    const ResultKey key = keyOf(result);
    if (!lies.contain(result) || !isIn(plans, key)) continue;
    if (honestly_answered.contains(key) && !spoiled.contains(key) && !tables_hurt)
      throw Broken("a lie is sealed that somebody contradicted");
    sealed_lies.emplace(key, std::move(result));
  }
}

void Ledger::checkRecorded(const std::vector<wire::Result>& recorded) const {
  std::set<ResultKey> keys;
  for (const wire::Result& result : recorded) {
    const ResultKey key = keyOf(result);
    if (!keys.insert(key).second && !spoiled.contains(key))
      throw Broken("a result is recorded twice");
    if (isCovered(cleaned_of, result.given_by()))
      throw Broken("a result is recorded of a worker that is kept out");
  }
  for (const ResultKey& key : acknowledged)
    if (!keys.contains(key) && !mayBeLost(key))
      throw Broken("a result that was acknowledged is not recorded");
}

void Ledger::hurtTables() {
  tables_hurt = true;
  kept_out.clear();
  cleaned_of.clear();
}

}  // namespace palpate::simulation
