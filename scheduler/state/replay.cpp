#include "scheduler/state/replay.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

/// Returns the messages of a journal's gaps. The number of listed dropped records is limited,
/// because all results of an excluded worker may be among them.
std::vector<std::string> damageOf(std::vector<JournalGap> gaps) {
  constexpr std::size_t most_told = 8;
  std::vector<std::string> damage;
  std::size_t dropped = 0;
  for (JournalGap& gap : gaps)
    if (gap.kind != JournalGap::Kind::dropped || ++dropped <= most_told)
      damage.push_back(std::move(gap.text));
  if (dropped > most_told)
    damage.push_back(fmt::format("{} more records, dropped earlier", dropped - most_told));
  return damage;
}

/// Limits `expected`, which comes from tables that may be damaged, to the largest number of records
/// that a journal of this size can hold.
std::size_t atMostIn(const std::filesystem::path& directory, std::size_t expected) {
  constexpr std::uint64_t smallest_record = 100;
  constexpr std::uint64_t most = 1 << 26;  // 0.5 GB of buckets; a damaged count may have any value
  const std::uint64_t bytes =
      JournalReader(directory).bytesBefore(std::numeric_limits<std::uint32_t>::max());
  return std::min<std::size_t>(expected, std::min(most, bytes / smallest_record));
}

/// Records a result in the plan. Returns false, and does not record it, if it was solved from other
/// fields than those of the plan's parent point.
bool recordIn(SpacePlan& plan, const Transition& transition, const wire::Result& result,
              const Outcome& outcome) {
  PALPATE_ASSERT(keyOf(result) == plan.keyOf(transition), "the result must be of this transition");
  if (result.start_id() != startIdOf(plan, transition)) return false;
  plan.record(transition, outcome, fieldsOf(result));
  return true;
}

}  // namespace

ContentId fieldsOf(const wire::Result& result) {
  return ContentId::fromBytes(result.fields_id()).value_or(ContentId());
}

RecordedResults readResults(const std::filesystem::path& directory, const ContentId& build,
                            const TakeResult& take, std::size_t expected) {
  RecordedResults recorded;
  // Reserve now: growth would rehash all entries several times.
  recorded.where.reserve(atMostIn(directory, expected));
  std::vector<std::string> senseless;
  wire::Result result;  // reused, so its strings keep their memory
  const auto readRecord = [&](const JournalPosition& where, std::string_view header) {
    const bool readable = result.ParseFromArray(header.data(), static_cast<int>(header.size()));
    const std::optional<Outcome> outcome = readable ? fromWire(result) : std::nullopt;
    if (!outcome) {
      // The checksum is right, so another version of the program wrote the record, or this version
      // has a bug.
      senseless.push_back(fmt::format("{}: the record at byte {} is not a valid result",
                                      JournalReader(directory).segmentPath(where.segment).string(),
                                      where.offset));
      return;
    }
    if (result.build() != build.bytes())
      throw badInput(
          "{}: holds results of another build ({}, not {}): use another --state directory",
          directory.string(), ContentId::fromBytes(result.build()).value_or(ContentId()).shortHex(),
          build.shortHex());
    const ResultKey key = keyOf(result);
    if (!recorded.where.emplace(key, where).second) return;
    take(key, result, *outcome);
  };
  JournalScan scan = JournalReader(directory).scan(readRecord);
  recorded.end = scan.end;
  recorded.torn = std::move(scan.torn);
  recorded.damage = damageOf(std::move(scan.gaps));
  recorded.damage.insert(recorded.damage.end(), senseless.begin(), senseless.end());
  return recorded;
}

std::optional<wire::Result> readRecorded(const JournalReader& journal, const ResultIndex& where,
                                         const ResultKey& key) {
  const auto position = where.find(key);
  PALPATE_ASSERT(position != where.end(), "the key must be of a recorded result");
  try {
    wire::Result result;
    if (result.ParseFromString(journal.readHeader(position->second))) return result;
  } catch (const DamagedRecord& damage) {
    spdlog::warn("{}; its result is computed again", damage.what());
  }
  return std::nullopt;
}

std::string startIdOf(const SpacePlan& plan, const Transition& transition) {
  // The origin is its own parent: it is solved from the rest state, which has no id.
  if (transition.target == transition.parent) return "";
  PALPATE_ASSERT(isSolved(plan.points().tag(transition.parent)),
                 "a transition must start at a solved point");
  return std::string(plan.points().fields(transition.parent).bytes());
}

void settle(SpacePlan& plan, UnclaimedResults& unclaimed, const ReadUnclaimed& read,
            Settled& settled) {
  for (auto ready = plan.takeReady(); !ready.empty(); ready = plan.takeReady())
    for (const Transition& transition : ready) {
      // Skip a transition that was recorded after takeReady().
      if (!plan.isOpen(transition)) continue;
      const ResultKey key = plan.keyOf(transition);
      const bool known = unclaimed.erase(key) > 0;
      const std::optional<wire::Result> result = known ? read(key) : std::nullopt;
      const std::optional<Outcome> outcome = result ? fromWire(*result) : std::nullopt;
      if (outcome && recordIn(plan, transition, *result, *outcome)) continue;
      if (known) settled.outdated.push_back(key);
      settled.missing.push_back(key);
    }
}

Replay::Replay(const Problem& problem) {
  plans.reserve(problem.active.size());
  for (std::uint32_t space = 0; space < problem.active.size(); ++space)
    plans.emplace_back(problem, space);
}

void Replay::take(const ResultKey& key, const wire::Result& result, const Outcome& outcome) {
  const std::optional<Transition> transition = findIn(plans, key);
  if (!transition || !plans[key.space].isOpen(*transition))
    unclaimed.insert(key);
  else if (!recordIn(plans[key.space], *transition, result, outcome))
    settled.outdated.push_back(key);
}

void Replay::finish(const ReadUnclaimed& read) {
  for (SpacePlan& plan : plans) {
    settle(plan, unclaimed, read, settled);
    PALPATE_ASSERT(plan.complete() || plan.openCount() > 0,
                   "an incomplete plan must have open transitions");
  }
}

ReplayedJournal replayJournal(const std::filesystem::path& directory, const Problem& problem,
                              const ContentId& build, const std::vector<KeptOut>& liars,
                              std::size_t expected) {
  ReplayedJournal found(problem);
  const auto take = [&](const ResultKey& key, const wire::Result& result, const Outcome& outcome) {
    const wire::Provenance& giver = result.given_by();
    if (std::ranges::any_of(liars, [&](const KeptOut& liar) { return liar.covers(giver); }))
      return found.of_liars.push_back(key);
    if (found.results++ == 0) found.kernel_family = result.kernel_family();
    found.longest_solve = std::max(found.longest_solve, outcome.cost.seconds);
    found.machines.emplace(giver.key(), giver.host());
    found.replay.take(key, result, outcome);
  };
  found.recorded = readResults(directory, build, take, expected);
  const JournalReader journal(directory);
  found.replay.finish(
      [&](const ResultKey& key) { return readRecorded(journal, found.recorded.where, key); });
  return found;
}

std::vector<ResultKey> failedWith(const std::vector<SpacePlan>& plans, Cause cause) {
  std::vector<ResultKey> keys;
  for (const SpacePlan& plan : plans)
    for (std::int32_t n = 0; n < plan.size(); ++n)
      for (const FailedAttempt& attempt : plan.points().attempts(n))
        if (attempt.failure.cause == cause) keys.push_back(plan.keyOf({n, attempt.parent}));
  return keys;
}

void refuseUnclaimed(const UnclaimedResults& unclaimed) {
  if (unclaimed.empty()) return;
  throw failure(
      "the state directory holds {} results that this version of palpate did not request (the "
      "first: {}): another version began the build; continue with that version, or remove the "
      "directory to compute everything again",
      unclaimed.size(), textOf(*unclaimed.begin()));
}

}  // namespace palpate
