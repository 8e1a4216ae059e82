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
  /// A point of which something that was recorded is lost, and computed again.
  struct LostPoint {
    std::string active;  ///< name of the active node
    LatticePoint point = {};
    std::int32_t divisions = 1;  ///< coordinates count in 1/divisions of a spacing
  };

  /// Process number of the scheduler that works there meanwhile: the journal was read as far as it
  /// was written then, and its records were not counted. Nothing when none does.
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
  std::string tables_text;  ///< what is wrong with them
  /// Results that are computed again: that many less are in the journal than the tables say.
  std::size_t lost_results = 0;
  std::vector<LostPoint> lost;  ///< of them those that can be named, by active node and point
  /// Results that no plan asks for: they wait for what was lost. Where nothing is, another version
  /// of the program recorded them.
  std::size_t spare = 0;
  std::vector<std::string> leftovers;  ///< files that nobody needs any more, for people

  /// Nothing is lost but what was dropped, and the next start goes on from all of it.
  bool whole() const;
};

/// Reads all of a state directory and changes nothing in it, which need not be writable: every
/// record with both checksums and what it says, the replay of all of them, and whether there are as
/// many as the tables say. While a scheduler works there, what was written when it began is read.
/// Error (bad input) when it is no state directory, or that of another version.
Inspection inspect(const std::filesystem::path& directory);
/// The same for whoever holds it.
Inspection inspect(const StateDirectory& held);

/// Drops what is damaged, and makes the tables again where they are damaged or missing; returns
/// what was done, for people. The next start of the build computes what was lost. Ended anywhere it
/// does no harm, and done again it does the rest. Error when the directory holds records of several
/// builds: nothing is changed then.
std::vector<std::string> repair(const StateDirectory& held, const Inspection& found);

}  // namespace palpate
