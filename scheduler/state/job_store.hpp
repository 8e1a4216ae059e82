#pragma once

#include "scheduler/state/journal.hpp"
#include "scheduler/state/result_key.hpp"
#include "scheduler/state/tables.hpp"

namespace palpate {

/// The id of a result's nodal fields; all zero of a failure.
ContentId fieldsOf(const wire::Result& result);

/// One result: its header as the worker sent it, less the lease, and who gave it.
struct StoredResult {
  wire::Result header;
  Outcome outcome;  ///< of the header; without fields
};
using StoredResults = std::map<ResultKey, StoredResult>;

/// What the journal of a build holds.
struct RecordedResults {
  StoredResults results;  ///< the first of each key
  std::map<ResultKey, JournalPosition> where;
  JournalEnd end;
  std::vector<JournalPosition> torn;  ///< JournalScan::torn
  /// What was recorded once and cannot be read any more, for people: it will be computed again.
  std::vector<std::string> damage;
};
/// Reads it. Error (bad input) when it is the journal of another build.
RecordedResults readResults(const std::filesystem::path& directory, const ContentId& build);
/// Those that one of these gave.
std::vector<ResultKey> givenBy(const std::vector<KeptOut>& liars, const StoredResults& results);

/// All that a state directory holds of a build, for its one scheduler: results, in the journal, and
/// tables beside them.
///
/// append() and commit() are the only way in, and commit() is what an acknowledgement promises: the
/// journal is synced when it returns. Nothing that a dataset is made of is read from the tables.
/// Errors of journal or tables are fatal for the scheduler, but for DamagedRecord. One thread.
class JobStore {
 public:
  /// Opens the state in `directory`, which must outlive this object, or makes it. `problem_bytes`
  /// is encodeProblem(problem). Error (bad input) when it belongs to another build, naming its
  /// scene, or to another version. What is damaged is told (log), and computed again.
  JobStore(const StateDirectory& directory, const Problem& problem,
           const std::string& problem_bytes,
           std::uint64_t segment_bytes = Journal::default_segment_bytes);

  const ContentId& build() const { return tables_.build().build; }
  Tables& tables() { return tables_; }
  /// Of the first result; empty before it.
  const std::string& kernelFamily() const { return kernel_family_; }
  /// The results that earlier runs left. May be taken once.
  StoredResults takeFound() { return std::exchange(recorded_.results, {}); }
  /// Some of what earlier runs left was lost or dropped.
  bool damaged() const { return !recorded_.damage.empty(); }

  /// Whose results are neither taken nor kept.
  const std::vector<KeptOut>& keptOut() const { return kept_out_; }
  /// Keeps these out too. Their results are dropped when the directory is opened next: this object
  /// must not be used afterwards.
  void keepOut(std::span<const KeptOut> liars) { tables_.keepOut(liars); }

  /// Appends a result that is not recorded yet. It is recorded once commit() has returned.
  void append(const wire::Result& header, std::string_view payload);
  /// Makes all that was appended durable.
  void commit();

  bool knows(const ResultKey& key) const { return recorded_.where.contains(key); }
  /// A recorded result; nothing when there is none with this key. DamagedRecord when it cannot be
  /// read any more.
  std::optional<JournalRecord> find(const ResultKey& key) const;
  /// The next scheduler computes this record again.
  void drop(const JournalPosition& damaged) { journal_.drop(damaged); }
  /// Recorded results that are to be computed again: they are not recorded any more.
  void drop(const std::vector<ResultKey>& keys);

  const std::filesystem::path& directory() const { return directory_->path(); }
  std::uint64_t journalBytes() const { return journal_.bytes(); }
  /// Error when the directory, its lock or a segment was removed or replaced meanwhile.
  void checkPresence() const;

 private:
  void dropWhatLiarsGave();

  const StateDirectory* directory_;
  Tables tables_;
  RecordedResults recorded_;
  Journal journal_;
  std::vector<std::pair<ResultKey, JournalPosition>> appended_;  ///< not committed yet
  std::string kernel_family_;
  std::vector<KeptOut> kept_out_;
};

}  // namespace palpate
