#include "scheduler/state/result_index.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

std::size_t hashOf(const ResultKey& key) {
  std::uint64_t hash = key.space;
  const auto mix = [&hash](std::int32_t value) {
    hash = (hash ^ static_cast<std::uint32_t>(value)) * 0x9e3779b97f4a7c15;
    hash ^= hash >> 29;
  };
  for (const std::int32_t coordinate : key.target) mix(coordinate);
  for (const std::int32_t coordinate : key.parent) mix(coordinate);
  return hash;
}

}  // namespace

std::size_t ResultIndex::slotOf(const ResultKey& key) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hashOf(key) & mask;
  for (; slots_[slot] != 0; slot = (slot + 1) & mask)
    if (const Entry& entry = entries_[slots_[slot] - 1];
        entry.key == key && entry.where.segment != erased)
      break;
  return slot;
}

bool ResultIndex::add(const ResultKey& key, const JournalPosition& where) {
  PALPATE_ASSERT(where.segment != erased && entries_.size() < UINT32_MAX, "it can be named");
  // At most five eighths are taken.
  if (8 * (entries_.size() + 1) > 5 * slots_.size()) grow();
  const std::size_t slot = slotOf(key);
  if (slots_[slot] != 0) return false;
  entries_.push_back({key, where});
  slots_[slot] = static_cast<std::uint32_t>(entries_.size());
  ++size_;
  return true;
}

void ResultIndex::erase(const ResultKey& key) {
  if (slots_.empty()) return;
  const std::uint32_t there = slots_[slotOf(key)];
  if (there == 0) return;
  entries_[there - 1].where.segment = erased;
  --size_;
}

std::optional<JournalPosition> ResultIndex::find(const ResultKey& key) const {
  if (slots_.empty()) return std::nullopt;
  const std::uint32_t there = slots_[slotOf(key)];
  return there == 0 ? std::nullopt : std::optional(entries_[there - 1].where);
}

void ResultIndex::grow() {
  constexpr std::size_t least = 64;
  slots_.assign(std::max(least, 2 * slots_.size()), 0);
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t n = 0; n < entries_.size(); ++n) {
    std::size_t slot = hashOf(entries_[n].key) & mask;
    while (slots_[slot] != 0) slot = (slot + 1) & mask;
    slots_[slot] = static_cast<std::uint32_t>(n + 1);
  }
}

}  // namespace palpate
