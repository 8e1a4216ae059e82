#include "scheduler/state/job_store.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/wire/wire.hpp"

namespace palpate {

ResultKey keyOf(const wire::Result& result) {
  return {result.space(), fromWire(result.target()), fromWire(result.parent())};
}

ContentId fieldsOf(const wire::Result& result) {
  return ContentId::fromBytes(result.fields_id()).value_or(ContentId());
}

RecordedResults readResults(const std::filesystem::path& directory, const ContentId& build) {
  JournalScan scan = JournalReader(directory).scan();
  RecordedResults recorded{
      .results = {}, .where = {}, .end = scan.end, .torn = std::move(scan.torn), .damage = {}};
  // All that a liar gave may have been dropped.
  constexpr std::size_t most_told = 8;
  std::size_t dropped = 0;
  for (JournalGap& gap : scan.gaps)
    if (gap.kind != JournalGap::Kind::dropped || ++dropped <= most_told)
      recorded.damage.push_back(std::move(gap.text));
  if (dropped > most_told)
    recorded.damage.push_back(
        fmt::format("{} more records, which were dropped", dropped - most_told));
  for (const auto& [where, header] : scan.records) {
    StoredResult result;
    std::optional<Outcome> outcome;
    if (result.header.ParseFromString(header)) outcome = fromWire(result.header);
    if (!outcome) {
      // Its checksum is right: another version of the program wrote it, or this one did wrongly.
      recorded.damage.push_back(fmt::format("segment {}, byte {}: a result that makes no sense",
                                            where.segment, where.offset));
      continue;
    }
    if (result.header.build() != build.bytes())
      throw badInput(
          "{}: holds results of another build ({}, not {}): use another --state directory",
          directory.string(),
          ContentId::fromBytes(result.header.build()).value_or(ContentId()).shortHex(),
          build.shortHex());
    result.outcome = std::move(*outcome);
    const ResultKey key = keyOf(result.header);
    recorded.where.try_emplace(key, where);
    recorded.results.try_emplace(key, std::move(result));
  }
  return recorded;
}

std::vector<ResultKey> givenBy(const std::vector<KeptOut>& liars, const StoredResults& results) {
  std::vector<ResultKey> theirs;
  for (const auto& [key, result] : results) {
    const wire::Provenance& giver = result.header.given_by();
    const auto isTheirs = [&giver](const KeptOut& liar) { return liar.covers(giver); };
    if (std::ranges::any_of(liars, isTheirs)) theirs.push_back(key);
  }
  return theirs;
}

JobStore::JobStore(const StateDirectory& directory, const Problem& problem,
                   const std::string& problem_bytes, std::uint64_t segment_bytes)
    : directory_(&directory),
      // The tables first: they know best what the directory of another build is about.
      tables_(directory, problem, problem_bytes),
      recorded_(readResults(directory.path(), tables_.build().build)),
      journal_(directory.path(), recorded_.end, segment_bytes) {
  journal_.dropAll(recorded_.torn);
  for (const std::string& damage : recorded_.damage)
    spdlog::warn("{}; what was recorded there is computed again", damage);
  dropWhatLiarsGave();
  if (!recorded_.results.empty())
    kernel_family_ = recorded_.results.begin()->second.header.kernel_family();
}

void JobStore::dropWhatLiarsGave() {
  kept_out_ = tables_.keptOut();
  const std::vector<ResultKey> theirs = givenBy(kept_out_, recorded_.results);
  if (theirs.empty()) return;
  drop(theirs);
  recorded_.damage.push_back(
      fmt::format("{} results are of workers that are kept out", theirs.size()));
}

void JobStore::drop(const std::vector<ResultKey>& keys) {
  std::vector<JournalPosition> positions;
  for (const ResultKey& key : keys) {
    const auto where = recorded_.where.find(key);
    PALPATE_ASSERT(where != recorded_.where.end(), "what is dropped was recorded");
    positions.push_back(where->second);
    recorded_.where.erase(where);
    recorded_.results.erase(key);
  }
  journal_.dropAll(std::move(positions));
}

void JobStore::append(const wire::Result& header, std::string_view payload) {
  const ResultKey key = keyOf(header);
  PALPATE_ASSERT(!knows(key), "the first result of a transition is the recorded one");
  appended_.emplace_back(key, journal_.append(header.SerializeAsString(), payload));
  kernel_family_ = header.kernel_family();
}

void JobStore::commit() {
  journal_.sync();
  for (const auto& [key, where] : appended_) recorded_.where.emplace(key, where);
  appended_.clear();
}

std::optional<JournalRecord> JobStore::find(const ResultKey& key) const {
  const auto found = recorded_.where.find(key);
  if (found == recorded_.where.end()) return std::nullopt;
  return journal_.read(found->second);
}

void JobStore::checkPresence() const {
  directory_->checkPresence();
  journal_.checkPresence();
}

}  // namespace palpate
