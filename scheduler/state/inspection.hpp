#pragma once

#include "scheduler/state/replay.hpp"
#include "scheduler/state/tables.hpp"

namespace palpate {

/// One place of a journal that is not what was written, or not of this build.
struct JournalDamage {
  JournalPosition where;         ///< length 0: the whole segment, which is missing
  std::string text;              ///< for people, with file and byte
  std::optional<ResultKey> key;  ///< of the result that was there, when its header can be read
};

/// What was found in a state directory, and what of it is damaged.
struct Inspection {
  enum class TableState : std::uint8_t {
    whole,
    missing,  ///< or empty: the next start of the build makes them
    damaged,  ///< likewise, once they are out of the way
  };
  /// A point that is computed again, because what was recorded of it is lost.
  struct LostPoint {
    std::string active;  ///< name of the active node
    LatticePoint point = {};
    std::int32_t divisions = 1;  ///< coordinates count in 1/divisions of a spacing
  };

  /// Process number of the scheduler that works there meanwhile: the journal was read as far as it
  /// was written then, and not compared with the tables. Nothing when none does.
  std::optional<std::string> scheduler;
  std::optional<ContentId> build;  ///< nothing when neither tables nor journal can say
  std::string scene_name;          ///< empty when the tables do not say
  std::optional<Problem> problem;  ///< when tables, or those put aside, hold it whole

  std::size_t segments = 0;
  std::size_t records = 0;       ///< whole, and of this build
  std::uint64_t bytes = 0;       ///< of all segments
  std::uint64_t unfinished = 0;  ///< bytes behind the last record, as a crash leaves them
  JournalEnd end;
  std::vector<JournalDamage> damage;
  std::vector<std::string> dropped;    ///< what was damaged once and is marked so, for people
  std::vector<JournalDamage> foreign;  ///< whole records of other builds

  TableState tables = TableState::whole;
  std::string tables_text;      ///< what is wrong with them
  std::size_t wrong_rows = 0;   ///< rows about a result that are not what the journal says of it
  std::size_t rows_behind = 0;  ///< rows of before the last results, as a crash leaves them
  std::vector<LostPoint> lost;  ///< by active node and point
  /// Results that no plan asks for: they wait for what was lost. Where nothing is, another version
  /// of the program recorded them.
  std::size_t spare = 0;
  std::vector<std::string> leftovers;  ///< files that nobody needs any more, for people

  /// Nothing is lost but what was dropped, and the next start goes on from all of it.
  bool whole() const;
};

/// Reads all of a state directory and changes nothing in it, which need not be writable: every
/// record with both checksums and what it says, the replay of all of them, and whether the tables
/// agree with it. While a scheduler works there, what was written when it began is read. Error (bad
/// input) when it is no state directory, or that of another version.
Inspection inspect(const std::filesystem::path& directory);
/// The same for whoever holds it.
Inspection inspect(const StateDirectory& held);

/// Drops what is damaged, and makes the tables again from the journal where they are damaged or say
/// something else; returns what was done, for people. The next start of the build computes what was
/// lost. Ended anywhere it does no harm, and done again it does the rest. Error when the directory
/// holds records of several builds: nothing is changed then.
std::vector<std::string> repair(const StateDirectory& held, const Inspection& found);

}  // namespace palpate
