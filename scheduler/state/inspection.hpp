#pragma once

#include "scheduler/state/replay.hpp"
#include "scheduler/state/tables.hpp"

namespace palpate {

/// Damage at one position of a journal, or a record of another build.
struct JournalDamage {
  JournalPosition where;         ///< length 0: the whole segment is missing
  std::string text;              ///< message with file and byte
  std::optional<ResultKey> key;  ///< of the result that was there, if its header can be read
};

/// Contents and damage of a state directory.
struct Inspection {
  enum class TableState : std::uint8_t {
    whole,
    missing,  ///< or empty: the next start of the build creates them
    damaged,  ///< the next start creates them once they are put aside
  };
  /// A point with a recorded result that was lost and is computed again.
  struct LostPoint {
    std::string active;  ///< name of the active node
    LatticePoint point = {};
    std::int32_t divisions = 1;  ///< coordinates per spacing
  };

  /// Process number of the scheduler that works there meanwhile, if any. The journal was then read
  /// as far as it was written, and its records were not compared with the tables.
  std::optional<std::string> scheduler;
  std::optional<ContentId> build;  ///< none if neither tables nor journal tell
  std::string scene_name;          ///< empty if the tables do not tell
  std::optional<Problem> problem;  ///< if the tables, or damaged tables put aside, hold it whole

  std::size_t segments = 0;
  std::size_t records = 0;       ///< whole and of this build
  std::uint64_t bytes = 0;       ///< of all segments
  std::uint64_t unfinished = 0;  ///< bytes behind the last record, left by a crash
  JournalEnd end;
  std::vector<JournalDamage> damage;
  std::vector<std::string> dropped;    ///< messages about damaged records marked as dropped
  std::vector<JournalDamage> foreign;  ///< whole records of other builds

  TableState tables = TableState::whole;
  std::string tables_text;  ///< damage of the tables
  /// Recorded results that are computed again: the number by which the tables count more than the
  /// journal holds.
  std::size_t lost_results = 0;
  std::vector<LostPoint> lost;  ///< points of the lost results that can be identified
  /// Recorded results that no plan asks for: they wait for lost results. If none were lost, another
  /// version of the program recorded them.
  std::size_t spare = 0;
  std::vector<std::string> leftovers;  ///< paths of files that are no longer needed

  /// True if nothing is lost except dropped records, and the next start continues from all of it.
  bool whole() const;
};

/// Reads the whole state directory without changing it; it need not be writable. Checks every
/// record's checksums and contents, replays all results, and compares their number with the tables.
/// While a scheduler works there, everything written before the call is read. Throws (bad input) if
/// the directory is no state directory, or has another version.
Inspection inspect(const std::filesystem::path& directory);
/// The same for the holder of the directory.
Inspection inspect(const StateDirectory& held);

/// Drops damaged records and recreates damaged or missing tables. Returns messages about the
/// changes. The next start of the build computes the lost results. A repair may be interrupted at
/// any moment and repeated. Throws, with nothing changed, if the directory holds records of several
/// builds.
std::vector<std::string> repair(const StateDirectory& held, const Inspection& found);

}  // namespace palpate
