#pragma once

#include "scheduler/state/replay.hpp"
#include "scheduler/state/tables.hpp"

namespace palpate {

/// The stored state of one build: the journal, which holds the results, and the tables. Only one
/// scheduler at a time may open it.
///
/// A result is recorded by append() and then commit(), which syncs the journal. A result may be
/// acknowledged only after commit() has returned. Nothing that goes into a dataset is read from the
/// tables. Errors of the journal or the tables are fatal for the scheduler, except DamagedRecord.
/// One thread.
class JobStore {
 public:
  /// Opens the state in `directory`, which must outlive this object, or creates it. Throws (bad
  /// input) if the state belongs to another version or another build; the message names the scene
  /// of that build. Logs damaged records; their results are computed again.
  JobStore(const StateDirectory& directory, const Problem& problem,
           std::uint64_t segment_bytes = Journal::default_segment_bytes);

  const ContentId& build() const { return tables_.build().build; }
  Tables& tables() { return tables_; }
  /// Kernel family that computed the results; empty before the first result.
  const std::string& kernelFamily() const { return found_.kernel_family; }
  /// Returns the plans with the results of earlier runs. Call once.
  Replay takeReplay() { return std::move(found_.replay); }
  std::size_t found() const { return found_.results; }  ///< number of results of earlier runs
  /// Key and host of each machine that computed results of earlier runs.
  const auto& machines() const { return found_.machines; }
  /// longest solve of earlier runs, s
  double longestSolve() const { return found_.longest_solve; }
  /// True if part of the results of earlier runs was lost or dropped.
  bool damaged() const { return !found_.recorded.damage.empty(); }

  /// Workers, machines and keys whose results are neither accepted nor kept.
  const std::vector<KeptOut>& keptOut() const { return kept_out_; }
  /// Excludes more workers. The next JobStore that opens the directory drops their results; do not
  /// use this one afterwards.
  void keepOut(std::span<const KeptOut> liars) { tables_.keepOut(liars); }

  /// Appends a result that is not recorded yet. The result is recorded once commit() returns.
  void append(const wire::Result& header, std::string_view payload);
  /// Makes everything that was appended durable.
  void commit();

  std::size_t recorded() const { return found_.recorded.where.size(); }  ///< number of results
  bool knows(const ResultKey& key) const { return found_.recorded.where.contains(key); }
  /// Returns the record of this result; none if the result is not recorded. Throws DamagedRecord if
  /// the record can no longer be read.
  std::optional<JournalRecord> find(const ResultKey& key) const;
  /// Returns a recorded result without its payload. If the record can no longer be read, logs that
  /// and returns none.
  std::optional<wire::Result> read(const ResultKey& key) const;
  /// Marks an unreadable record as dropped. The next scheduler computes its result again.
  void drop(const JournalPosition& damaged);
  /// Removes these recorded results, which must then be computed again.
  void drop(const std::vector<ResultKey>& keys);

  const std::filesystem::path& directory() const { return directory_->path(); }
  std::uint64_t journalBytes() const { return journal_.bytes(); }
  /// Throws if the directory, its lock or a segment was removed or replaced since it was opened.
  void checkPresence() const;

 private:
  void dropWhatLiarsGave();

  const StateDirectory* directory_;
  Tables tables_;
  std::vector<KeptOut> kept_out_;
  ReplayedJournal found_;
  Journal journal_;
  /// appended since the last commit()
  std::vector<std::pair<ResultKey, JournalPosition>> appended_;
};

}  // namespace palpate
