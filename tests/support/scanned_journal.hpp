#pragma once

#include "scheduler/state/journal.hpp"

namespace palpate::test {

/// The result of a scan of a journal, with the records.
struct ScannedJournal : JournalScan {
  struct Found {
    JournalPosition where;
    std::string header;
  };
  std::vector<Found> records;  ///< in the order of appending
};

inline ScannedJournal scanned(const JournalReader& reader) {
  ScannedJournal found;
  static_cast<JournalScan&>(found) =
      reader.scan([&](const JournalPosition& where, std::string_view header) {
        found.records.push_back({where, std::string(header)});
      });
  return found;
}

}  // namespace palpate::test
