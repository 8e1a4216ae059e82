#include "scheduler/state/recorded_results.hpp"

#include <spdlog/spdlog.h>

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

}  // namespace

ResultKey keyOf(const wire::Result& result) {
  return {result.space(), fromWire(result.target()), fromWire(result.parent())};
}

std::string textOf(const ResultKey& key) {
  const auto& [space, target, parent] = key;
  return fmt::format("space {}, point ({}, {}, {}) from ({}, {}, {})", space, target[0], target[1],
                     target[2], parent[0], parent[1], parent[2]);
}

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

}  // namespace palpate
