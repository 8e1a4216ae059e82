#include "scheduler/state/replay.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

/// Gaps of a journal for people. All that a liar gave may have been dropped.
std::vector<std::string> damageOf(std::vector<JournalGap> gaps) {
  constexpr std::size_t most_told = 8;
  std::vector<std::string> damage;
  std::size_t dropped = 0;
  for (JournalGap& gap : gaps)
    if (gap.kind != JournalGap::Kind::dropped || ++dropped <= most_told)
      damage.push_back(std::move(gap.text));
  if (dropped > most_told)
    damage.push_back(fmt::format("{} more records, which were dropped", dropped - most_told));
  return damage;
}

/// Into one that is there already, whose strings have room.
bool readInto(StoredResult& result, std::string_view header) {
  if (!result.header.ParseFromArray(header.data(), static_cast<int>(header.size()))) return false;
  std::optional<Outcome> outcome = fromWire(result.header);
  if (!outcome) return false;
  result.outcome = std::move(*outcome);
  return true;
}

/// Whether it was solved from what the plan has as its start.
bool startsThere(const SpacePlan& plan, const Transition& transition, const wire::Result& result) {
  return result.start_id() == startIdOf(plan, transition);
}

void append(Settled& all, const Settled& more) {
  all.missing.insert(all.missing.end(), more.missing.begin(), more.missing.end());
  all.stale.insert(all.stale.end(), more.stale.begin(), more.stale.end());
}

}  // namespace

ContentId fieldsOf(const wire::Result& result) {
  return ContentId::fromBytes(result.fields_id()).value_or(ContentId());
}

std::optional<StoredResult> storedResult(std::string_view header) {
  StoredResult result;
  return readInto(result, header) ? std::optional(std::move(result)) : std::nullopt;
}

RecordedResults readResults(const std::filesystem::path& directory, const ContentId& build,
                            const TakeResult& take) {
  RecordedResults recorded;
  std::vector<std::string> senseless;
  StoredResult result;
  const auto readRecord = [&](const JournalPosition& where, std::string_view header) {
    if (!readInto(result, header)) {
      // Its checksum is right: another version of the program wrote it, or this one did wrongly.
      senseless.push_back(fmt::format("segment {}, byte {}: a result that makes no sense",
                                      where.segment, where.offset));
      return;
    }
    if (result.header.build() != build.bytes())
      throw badInput(
          "{}: holds results of another build ({}, not {}): use another --state directory",
          directory.string(),
          ContentId::fromBytes(result.header.build()).value_or(ContentId()).shortHex(),
          build.shortHex());
    const ResultKey key = keyOf(result.header);
    if (!recorded.where.emplace(key, where).second) return;
    take(key, result);
  };
  JournalScan scan = JournalReader(directory).scan(readRecord);
  recorded.end = scan.end;
  recorded.torn = std::move(scan.torn);
  recorded.damage = damageOf(std::move(scan.gaps));
  recorded.damage.insert(recorded.damage.end(), senseless.begin(), senseless.end());
  return recorded;
}

std::optional<StoredResult> readRecorded(const JournalReader& journal, const ResultIndex& where,
                                         const ResultKey& key) {
  const auto position = where.find(key);
  PALPATE_ASSERT(position != where.end(), "callers know that it is recorded");
  try {
    return storedResult(journal.readHeader(position->second));
  } catch (const DamagedRecord& damage) {
    spdlog::warn("{}: it is computed again", damage.what());
    return std::nullopt;
  }
}

std::string startIdOf(const SpacePlan& plan, const Transition& transition) {
  // The origin is its own parent: it is solved from the rest state, which has no id.
  if (transition.target == transition.parent) return "";
  PALPATE_ASSERT(isSolved(plan.points().tag(transition.parent)),
                 "a plan asks for transitions from solved points only");
  return std::string(plan.points().fields(transition.parent).bytes());
}

ResultKey keyOf(const std::vector<SpacePlan>& plans, const TransitionKey& key) {
  const Lattice& positions = plans[key.space].positions();
  return {key.space, positions.point(key.target), positions.point(key.parent)};
}

std::optional<TransitionKey> transitionOf(const std::vector<SpacePlan>& plans,
                                          const ResultKey& key) {
  if (key.space >= plans.size()) return std::nullopt;
  const Lattice& positions = plans[key.space].positions();
  const auto to = positions.indexOf(key.target), from = positions.indexOf(key.parent);
  return to && from ? std::optional(TransitionKey{key.space, *to, *from}) : std::nullopt;
}

Settled settle(std::vector<SpacePlan>& plans, std::uint32_t space, SpareResults& spare,
               const ReadSpare& read) {
  SpacePlan& plan = plans[space];
  Settled settled;
  for (auto ready = plan.takeReady(); !ready.empty(); ready = plan.takeReady())
    for (const Transition& transition : ready) {
      // Recorded meanwhile.
      if (!plan.isOpen(transition)) continue;
      const TransitionKey missing = {space, transition.target, transition.parent};
      const ResultKey key = keyOf(plans, missing);
      const bool known = spare.erase(key) > 0;
      const std::optional<StoredResult> result = known ? read(key) : std::nullopt;
      if (result && startsThere(plan, transition, result->header)) {
        plan.record(transition, result->outcome, fieldsOf(result->header));
        continue;
      }
      if (known) settled.stale.push_back(key);
      settled.missing.push_back(missing);
    }
  return settled;
}

Replay::Replay(const Problem& problem) {
  plans.reserve(problem.active.size());
  for (std::uint32_t space = 0; space < problem.active.size(); ++space)
    plans.emplace_back(problem, space);
}

void Replay::take(const ResultKey& key, const StoredResult& result) {
  const std::optional<TransitionKey> known = transitionOf(plans, key);
  const Transition transition = known ? Transition{known->target, known->parent} : Transition();
  if (!known || !plans[key.space].isOpen(transition)) {
    spare.insert(key);
  } else if (SpacePlan& plan = plans[key.space]; startsThere(plan, transition, result.header)) {
    plan.record(transition, result.outcome, fieldsOf(result.header));
  } else {
    settled.stale.push_back(key);
  }
}

void Replay::finish(const ReadSpare& read) {
  for (std::uint32_t space = 0; space < plans.size(); ++space) {
    append(settled, settle(plans, space, spare, read));
    PALPATE_ASSERT(plans[space].complete() || plans[space].openCount() > 0,
                   "a plan that asks for nothing has nothing left to do");
  }
}

ReplayedJournal replayJournal(const std::filesystem::path& directory, const Problem& problem,
                              const ContentId& build, const std::vector<KeptOut>& liars) {
  ReplayedJournal found(problem);
  const auto take = [&](const ResultKey& key, const StoredResult& result) {
    const wire::Provenance& giver = result.header.given_by();
    if (std::ranges::any_of(liars, [&](const KeptOut& liar) { return liar.covers(giver); })) {
      found.of_liars.push_back(key);
      return;
    }
    if (found.results++ == 0) found.kernel_family = result.header.kernel_family();
    found.longest_solve = std::max(found.longest_solve, result.outcome.cost.seconds);
    found.givers.emplace(giver.key(), giver.host());
    found.replay.take(key, result);
  };
  found.recorded = readResults(directory, build, take);
  const JournalReader journal(directory);
  found.replay.finish(
      [&](const ResultKey& key) { return readRecorded(journal, found.recorded.where, key); });
  return found;
}

std::vector<ResultKey> failedWith(const std::vector<SpacePlan>& plans, Cause cause) {
  std::vector<ResultKey> keys;
  for (std::uint32_t space = 0; space < plans.size(); ++space) {
    const SpacePlan& plan = plans[space];
    for (std::int32_t n = 0; n < plan.size(); ++n)
      for (const FailedAttempt& attempt : plan.attempts(n))
        if (attempt.failure.cause == cause)
          keys.push_back(keyOf(plans, {space, n, attempt.parent}));
  }
  return keys;
}

void refuseSpare(const SpareResults& spare) {
  if (spare.empty()) return;
  throw failure(
      "the state directory holds {} results that nobody asked for (the first: {}): another version "
      "of palpate began it, which asked for others; go on with that one, or remove the directory "
      "to compute everything again",
      spare.size(), textOf(*spare.begin()));
}

std::vector<SpaceTable> spaceTables(const std::vector<SpacePlan>& plans) {
  std::vector<SpaceTable> tables;
  for (const SpacePlan& plan : plans) tables.push_back(plan.table());
  return tables;
}

}  // namespace palpate
