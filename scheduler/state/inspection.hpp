#pragma once

#include "scheduler/state/replay.hpp"
#include "scheduler/state/tables.hpp"

namespace palpate {

/// One damaged place of a journal, or one record that belongs to another build.
struct JournalDamage {
  JournalPosition where;  ///< has length 0 if the whole segment is missing
  std::string text;       ///< message with file and byte
  /// key of the result at this place; none if its header cannot be read
  std::optional<ResultKey> key;
};

/// Contents and damage of a state directory.
struct Inspection {
  enum class TableState : std::uint8_t {
    whole,
    missing,  ///< no file, or an empty one; the next start of the build creates the tables
    damaged,  ///< the next start renames the damaged file and creates new tables
  };
  /// A point whose recorded result was lost and is computed again.
  struct LostPoint {
    std::string active;  ///< name of the active node
    LatticePoint point = {};
    std::int32_t divisions = 1;  ///< lattice coordinates per spacing
  };

  /// Process id of the scheduler that held the directory during the inspection, or "unknown"; none
  /// if no scheduler held it. If a scheduler held it, the journal is read as far as it was written,
  /// and the number of records is not compared with the tables.
  std::optional<std::string> scheduler;
  std::optional<ContentId> build;  ///< none if neither the tables nor the journal name a build
  std::string scene_name;          ///< empty if the tables cannot be read
  /// none if no readable problem is in the tables or in state.db.damaged
  std::optional<Problem> problem;

  std::size_t segments = 0;
  std::size_t records = 0;       ///< undamaged records of this build
  std::uint64_t bytes = 0;       ///< total size of all segments
  std::uint64_t unfinished = 0;  ///< number of bytes after the last record, left by a crash
  JournalPosition end;
  std::vector<JournalDamage> damage;
  std::vector<std::string> dropped;    ///< messages about the records that are marked as dropped
  std::vector<JournalDamage> foreign;  ///< undamaged records of other builds

  TableState tables = TableState::whole;
  std::string tables_text;  ///< message about the damage of the tables
  /// Number of lost results, which are computed again. The tables counted this many more results
  /// than the journal holds.
  std::size_t lost_results = 0;
  std::vector<LostPoint> lost;  ///< points whose results are known to be lost
  /// Number of recorded results that no plan asks for yet, because results that they depend on were
  /// lost. If no result was lost, another version of the program recorded them.
  std::size_t spare = 0;
  std::vector<std::string> leftovers;  ///< paths of files that are no longer needed

  /// True if nothing is damaged, lost, or left by another build or program version, apart from
  /// records that are already marked as dropped. The next start of the build then continues from
  /// all recorded results.
  bool whole() const;
};

/// Inspects a state directory without changing it. The directory need not be writable. Checks every
/// record's checksums and contents, replays all results, and compares their number with the tables.
/// If a scheduler is running there, reads everything that was written before the call. Throws (bad
/// input) if the directory is not a state directory, or has another version.
Inspection inspect(const std::filesystem::path& directory);
/// Inspects a state directory whose lock the caller holds.
Inspection inspect(const StateDirectory& held);

/// Marks damaged records as dropped. Recreates damaged or missing tables if Inspection::problem is
/// known. Returns messages about the changes. The next start of the build computes the lost
/// results. A repair may be interrupted at any moment and repeated. Throws without changing
/// anything if the directory holds records of several builds.
std::vector<std::string> repair(const StateDirectory& held, const Inspection& found);

}  // namespace palpate
