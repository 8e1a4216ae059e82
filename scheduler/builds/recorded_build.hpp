#pragma once

#include "scheduler/builds/build.hpp"

namespace palpate {

/// Read-only snapshot of the build in a state directory. A scheduler may be running there. The
/// snapshot omits results of excluded workers, and includes every open check of its results. One
/// thread.
class RecordedBuild {
 public:
  /// Throws Error (bad input) if this is not a state directory of this version. Logs any damage.
  explicit RecordedBuild(std::filesystem::path directory);
  RecordedBuild(const RecordedBuild&) = delete;
  RecordedBuild& operator=(const RecordedBuild&) = delete;

  const Problem& problem() const { return problem_; }
  StoredTables& tables() { return *tables_; }
  /// One plan per active node.
  const std::vector<SpacePlan>& plans() const { return found_->replay.plans; }
  /// Kernel family of all results; empty before the first result.
  const std::string& kernelFamily() const { return found_->kernel_family; }
  /// Returns true if every space is complete and no check is open.
  bool complete();
  /// Writes the dataset and returns its rows. Marks it as partial unless the build is complete.
  /// Throws Error if no result is recorded yet, and DamagedRecord if a result cannot be read.
  SpaceRowsList seal(const std::filesystem::path& file);

 private:
  std::optional<JournalRecord> find(const ResultKey& key) const;

  const std::filesystem::path directory_;
  JournalReader journal_;
  std::optional<StoredTables> tables_;  ///< opened after the journal was read
  const Problem problem_;
  std::optional<ReplayedJournal> found_;
};

/// Returns the status that the last scheduler in `directory` stored (progressOf). If no status is
/// stored or it is unreadable, computes one from the journal, which takes the time and memory of a
/// scheduler's start. Throws Error (bad input) if this is not a state directory of this version.
wire::Status progressIn(const std::filesystem::path& directory);

}  // namespace palpate
