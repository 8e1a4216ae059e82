#pragma once

#include "scheduler/state/replay.hpp"
#include "scheduler/state/tables.hpp"

namespace palpate {

/// The state of a build in its directory, for the one scheduler that works there: the journal with
/// the results, and the tables.
///
/// append() and commit() are the only way to record a result. An acknowledgement promises that
/// commit() returned: the journal is synced then. Nothing that goes into a dataset is read from the
/// tables. Errors of the journal or the tables are fatal for the scheduler, except DamagedRecord.
/// One thread.
class JobStore {
 public:
  /// Opens the state in `directory`, which must outlive this object, or creates it. Throws (bad
  /// input) if it belongs to another version or another build; the message names the scene of that
  /// build. Damaged records are logged and computed again.
  JobStore(const StateDirectory& directory, const Problem& problem,
           std::uint64_t segment_bytes = Journal::default_segment_bytes);

  const ContentId& build() const { return tables_.build().build; }
  Tables& tables() { return tables_; }
  /// Kernel family that computed the results; empty before the first result.
  const std::string& kernelFamily() const { return kernel_family_; }
  /// Returns the results of earlier runs, recorded in plans. Call once.
  Replay takeReplay() { return std::move(found_.replay); }
  std::size_t found() const { return found_.results; }  ///< number of results of earlier runs
  /// Machines that gave the results of earlier runs: key and host.
  const auto& machines() const { return found_.machines; }
  double longestSolve() const { return found_.longest_solve; }  ///< in earlier runs, s
  /// True if part of the results of earlier runs was lost or dropped.
  bool damaged() const { return !found_.recorded.damage.empty(); }

  /// Workers, machines and keys whose results are neither accepted nor kept.
  const std::vector<KeptOut>& keptOut() const { return kept_out_; }
  /// Excludes more workers. Their results are dropped when the directory is opened next, so this
  /// object must not be used afterwards.
  void keepOut(std::span<const KeptOut> liars) { tables_.keepOut(liars); }

  /// Appends a result that is not recorded yet. It is recorded once commit() returns.
  void append(const wire::Result& header, std::string_view payload);
  /// Makes everything that was appended durable.
  void commit();

  std::size_t recorded() const { return found_.recorded.where.size(); }  ///< number of results
  bool knows(const ResultKey& key) const { return found_.recorded.where.contains(key); }
  /// Returns a recorded result; none if there is none with this key. Throws DamagedRecord if it
  /// cannot be read any more.
  std::optional<JournalRecord> find(const ResultKey& key) const;
  /// Returns a recorded result without its payload; none, with a log line, if it cannot be read any
  /// more.
  std::optional<wire::Result> read(const ResultKey& key) const;
  /// Marks a record that cannot be read. The next scheduler computes it again.
  void drop(const JournalPosition& damaged);
  /// Removes recorded results, which must then be computed again.
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
  std::vector<std::pair<ResultKey, JournalPosition>> appended_;  ///< not committed yet
  std::string kernel_family_;
};

}  // namespace palpate
