#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "scheduler/state/journal.hpp"
#include "scheduler/state/result_key.hpp"

namespace palpate {

/// Where each recorded result lies in the journal, in about 60 bytes each: there may be ten
/// million. Copyable, one thread at a time.
class ResultIndex {
 public:
  /// Whether it is the first of its key; another one is not added.
  bool add(const ResultKey& key, const JournalPosition& where);
  void erase(const ResultKey& key);
  std::optional<JournalPosition> find(const ResultKey& key) const;
  bool contains(const ResultKey& key) const { return find(key).has_value(); }
  std::size_t size() const { return size_; }

  /// visit(key, position) in the order of adding.
  template <class Visit>
  void forEach(const Visit& visit) const {
    for (const Entry& entry : entries_)
      if (entry.where.segment != erased) visit(entry.key, entry.where);
  }

 private:
  static constexpr std::uint32_t erased = 0;  ///< segments are numbered from 1
  struct Entry {
    ResultKey key;
    JournalPosition where;
  };

  /// The slot of this key, or the free one where it would be.
  std::size_t slotOf(const ResultKey& key) const;
  void grow();

  std::deque<Entry> entries_;
  /// An open hash table: 0, or 1 + the place in entries_. Erased entries keep their slots.
  std::vector<std::uint32_t> slots_;
  std::size_t size_ = 0;  ///< less what was erased
};

}  // namespace palpate
