#pragma once

#include <map>
#include <optional>
#include <span>

#include "proto/palpate.pb.h"
#include "scheduler/plan/leases.hpp"
#include "scheduler/plan/space_plan.hpp"
#include "scheduler/state/kept_out.hpp"
#include "scheduler/state/sqlite.hpp"
#include "scheduler/state/state_directory.hpp"

namespace palpate {

/// Identity of the build in a state directory.
struct StoredBuild {
  ContentId build;
  std::string scene_name;
  std::string problem;  ///< bytes of encodeProblem()
};
/// Decodes the problem; none if it is damaged or does not match the build id.
std::optional<Problem> problemOf(const StoredBuild& build);

/// Progress of a build, which its scheduler stores from time to time.
struct Progress {
  /// number of results in the journal when the progress was stored
  std::size_t recorded = 0;
  std::string status;  ///< a wire::Status as JSON (progressOf)
};

/// Counters of a build by name (docs/internals/state.md).
using Counters = std::map<std::string, std::int64_t>;

/// Reads the tables of a build (SQLite, docs/internals/state.md). An object made from a directory
/// shows a snapshot taken at construction, even while a scheduler writes the tables. Results are
/// not in the tables but in the journal; counts in the tables only inform users. One thread.
class StoredTables {
 public:
  static constexpr int schema_version = 6;

  /// Throws (bad input) if `directory` is not a state directory, or has another version. The
  /// directory need not be writable. With Access::read_untouched nothing in it is changed.
  explicit StoredTables(const std::filesystem::path& directory,
                        Database::Access access = Database::Access::read_only);

  const StoredBuild& build() const { return build_; }
  /// Reads the whole file. Throws DamagedDatabase if its contents are inconsistent.
  void verify();
  /// Returns the last stored progress; none if a record has been dropped from the journal since.
  std::optional<Progress> progress();
  /// Returns the workers, each with its full id in hexadecimal.
  std::vector<wire::WorkerStatus> servers();
  Counters counters();
  /// True if the build is paused: its scheduler hands out no work until `palpate resume`.
  bool paused();
  /// Returns the priorities that users have set, keyed by the name of a status row (rowNameOf).
  std::map<std::string, std::int32_t> priorities();
  std::vector<KeptOut> keptOut();
  /// Returns the results that other workers are to solve again, including results that are not
  /// recorded yet. The value is true if two results of the transition differ.
  std::map<ResultKey, bool> checks();

 protected:
  explicit StoredTables(Database database) : database_(std::move(database)) {}
  /// Reads the identity of the build. Throws (bad input) if the tables are not Palpate's, or are of
  /// another version.
  void readBuild();

  Database database_;
  StoredBuild build_;
};

/// Writes the tables. Their only writer owns the StateDirectory. No acknowledgement depends on the
/// tables, so most changes are not synced at once: after a power cut, the tables may show an
/// earlier state. Errors of the database are fatal for the scheduler. One thread.
class Tables : public StoredTables {
 public:
  /// Opens the tables in `directory`, or creates them. Throws (bad input) if they belong to another
  /// version or another build; the message names the scene of that build. If the tables are damaged
  /// and there is a journal, renames them to state.db.damaged and creates new ones.
  Tables(const StateDirectory& directory, const Problem& problem)
      : Tables(directory, problem, problemId(problem)) {}
  /// Opens existing tables of any build.
  explicit Tables(const StateDirectory& directory);

  void writeProgress(const Progress& progress);
  /// Removes the stored progress. Call before a record is dropped from the journal. Synced on
  /// return.
  void forgetProgress();

  /// Limit on the rows of workers that left without a result. The latest rows are kept.
  static constexpr std::int64_t most_idle_departed = 1000;
  /// Inserts or replaces the rows of these workers, then applies the limit most_idle_departed. Each
  /// heard_seconds_ago counts back from the time of the call.
  void writeServers(std::span<const wire::WorkerStatus> servers);
  void writeCounters(const Counters& counters);

  /// A transition as the tables identify it: its space, and the point numbers in the plan of that
  /// space. The losses of a transition (its hand-outs and the deaths of workers) are kept across
  /// runs.
  using NumberedTransition = std::pair<std::uint32_t, Transition>;
  void writeLosses(const NumberedTransition& which, const Losses& losses);
  std::map<NumberedTransition, Losses> losses();
  /// Removes all losses. Returns how many transitions were set aside before.
  std::int64_t forgetLosses();

  /// Excludes workers in this and all later runs. Synced on return.
  void keepOut(std::span<const KeptOut> liars);

  /// These two changes are synced on return.
  void writePaused(bool paused);
  void writePriority(const std::string& name, std::int32_t priority);

  /// Stores a check, which is kept across runs. A disputed check is synced on return, so it also
  /// survives a power cut.
  void writeCheck(const ResultKey& key, bool disputed);
  void forgetCheck(const ResultKey& key);
  /// Returns 32 secret bytes, which only this scheduler knows. If the tables were damaged and lost
  /// the secret, makes a new one.
  std::string secret();

 private:
  Tables(const StateDirectory& directory, const Problem& problem, const ContentId& wanted);
  void create(const Problem& problem, const ContentId& build);
  /// Runs `change` in a transaction that is synced on return. A power cut may undo changes that are
  /// made in any other way.
  void durably(const std::function<void()>& change);
};

/// Renames damaged tables to state.db.damaged, replacing an older file of that name. New tables can
/// then be created. Throws if that fails.
void putTablesAside(const StateDirectory& directory);

}  // namespace palpate
