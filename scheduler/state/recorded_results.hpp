#pragma once

#include <functional>
#include <unordered_map>

#include "common/space/configuration.hpp"
#include "scheduler/state/journal.hpp"
#include "scheduler/state/result_key.hpp"

namespace palpate {

/// One result: its header as the worker sent it, less the lease, and who gave it.
struct StoredResult {
  wire::Result header;
  Outcome outcome;  ///< of the header; without fields
};
/// What a header says; nothing when it makes no sense.
std::optional<StoredResult> storedResult(std::string_view header);

/// The id of a result's nodal fields; all zero of a failure.
ContentId fieldsOf(const wire::Result& result);

/// Where each recorded result lies in the journal, in about 90 bytes each: there may be ten
/// million.
using ResultIndex = std::unordered_map<ResultKey, JournalPosition, HashOfResultKey>;

/// What the journal of a build holds, but for the results themselves.
struct RecordedResults {
  ResultIndex where;  ///< the first of each key
  JournalEnd end;
  std::vector<JournalPosition> torn;  ///< JournalScan::torn
  /// What was recorded once and cannot be read any more, for people: it will be computed again.
  std::vector<std::string> damage;
};

using TakeResult = std::function<void(const ResultKey&, const StoredResult&)>;
/// Reads it, and calls `take` with the first result of each key, in the order of recording: all of
/// them may not fit into memory. Error (bad input) when it is the journal of another build.
RecordedResults readResults(const std::filesystem::path& directory, const ContentId& build,
                            const TakeResult& take);

/// One that is in the index, without its payload; nothing when it cannot be read any more, which is
/// told (log).
std::optional<StoredResult> readRecorded(const JournalReader& journal, const ResultIndex& where,
                                         const ResultKey& key);

}  // namespace palpate
