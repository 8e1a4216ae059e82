#pragma once

#include "scheduler/state/replay.hpp"
#include "scheduler/state/tables.hpp"

namespace palpate {

/// All that a state directory holds of a build, for its one scheduler: results, in the journal, and
/// tables beside them.
///
/// append() and commit() are the only way in, and commit() is what an acknowledgement promises: the
/// journal is synced when it returns. Nothing that a dataset is made of is read from the tables.
/// Errors of journal or tables are fatal for the scheduler, but for DamagedRecord. One thread.
class JobStore {
 public:
  /// Opens the state in `directory`, which must outlive this object, or makes it. Error (bad input)
  /// when it belongs to another build, naming its scene, or to another version. What is damaged is
  /// told (log), and computed again.
  JobStore(const StateDirectory& directory, const Problem& problem,
           std::uint64_t segment_bytes = Journal::default_segment_bytes);

  const ContentId& build() const { return tables_.build().build; }
  Tables& tables() { return tables_; }
  /// Of the first result; empty before it.
  const std::string& kernelFamily() const { return kernel_family_; }
  /// The results that earlier runs left, in plans. May be taken once.
  Replay takeReplay() { return std::move(found_.replay); }
  std::size_t found() const { return found_.results; }  ///< so many
  /// The machines of those who gave them: key and host.
  const auto& machines() const { return found_.machines; }
  double longestSolve() const { return found_.longest_solve; }  ///< of them, s
  /// Some of what earlier runs left was lost or dropped.
  bool damaged() const { return !found_.recorded.damage.empty(); }

  /// Whose results are neither taken nor kept.
  const std::vector<KeptOut>& keptOut() const { return kept_out_; }
  /// Keeps these out too. Their results are dropped when the directory is opened next: this object
  /// must not be used afterwards.
  void keepOut(std::span<const KeptOut> liars) { tables_.keepOut(liars); }

  /// Appends a result that is not recorded yet. It is recorded once commit() has returned.
  void append(const wire::Result& header, std::string_view payload);
  /// Makes all that was appended durable.
  void commit();

  std::size_t recorded() const { return found_.recorded.where.size(); }  ///< so many results
  bool knows(const ResultKey& key) const { return found_.recorded.where.contains(key); }
  /// A recorded result; nothing when there is none with this key. DamagedRecord when it cannot be
  /// read any more.
  std::optional<JournalRecord> find(const ResultKey& key) const;
  /// One that is recorded, without its payload; nothing when it cannot be read any more, which is
  /// told (log).
  std::optional<wire::Result> read(const ResultKey& key) const;
  /// The next scheduler computes this record again.
  void drop(const JournalPosition& damaged);
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
  std::vector<KeptOut> kept_out_;
  ReplayedJournal found_;
  Journal journal_;
  std::vector<std::pair<ResultKey, JournalPosition>> appended_;  ///< not committed yet
  std::string kernel_family_;
};

}  // namespace palpate
