#pragma once

#include "scheduler/builds/build.hpp"

namespace palpate {

/// What a state directory holds of a build as of now, only read: whether a scheduler works in it or
/// not. Results of workers that are kept out are left out, and no open check of a result is missed,
/// whatever a scheduler writes meanwhile. One thread.
class RecordedBuild {
 public:
  /// Error (bad input) when it is no state directory, or one of another version; what is damaged in
  /// it is told (log).
  explicit RecordedBuild(std::filesystem::path directory);
  RecordedBuild(const RecordedBuild&) = delete;
  RecordedBuild& operator=(const RecordedBuild&) = delete;

  const Problem& problem() const { return problem_; }
  StoredTables& tables() { return *tables_; }
  /// One per active node.
  const std::vector<SpacePlan>& plans() const { return found_->replay.plans; }
  /// Of every result; empty before the first.
  const std::string& kernelFamily() const { return found_->kernel_family; }
  /// Every space is complete, and no check is open.
  bool complete();
  /// Writes its dataset, partial unless it is complete; returns the rows. Error when nothing is
  /// recorded yet; DamagedRecord when a result cannot be read (any more).
  SpaceRowsList seal(const std::filesystem::path& file);

 private:
  std::optional<JournalRecord> find(const ResultKey& key) const;

  const std::filesystem::path directory_;
  JournalReader journal_;
  std::optional<StoredTables> tables_;  ///< read after the journal
  const Problem problem_;
  std::optional<ReplayedJournal> found_;
};

/// How far the build in `directory` is, as its last scheduler said (progressOf); if that did not,
/// from the journal, which takes the time and memory of a start there. Error (bad input) when it is
/// no state directory, or one of another version.
wire::Status progressIn(const std::filesystem::path& directory);

}  // namespace palpate
