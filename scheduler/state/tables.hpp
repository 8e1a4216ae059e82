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

/// Progress of a build, as its scheduler writes it now and then.
struct Progress {
  std::size_t recorded = 0;  ///< results in the journal, which may hold more by now
  std::string status;        ///< human-readable: a wire::Status as JSON (progressOf)
};

/// Counters of a build by name (docs/state.md).
using Counters = std::map<std::string, std::int64_t>;

/// The tables of a build (SQLite, docs/state.md), for reading. Opened by directory, they are a
/// snapshot taken at construction, even while a scheduler writes them. They hold no results, which
/// are in the journal; their numbers are only informative. One thread.
class StoredTables {
 public:
  static constexpr int schema_version = 6;

  /// Throws (bad input) if `directory` is not a state directory, or has another version. The
  /// directory need not be writable. With Access::read_untouched nothing in it is changed.
  explicit StoredTables(const std::filesystem::path& directory,
                        Database::Access access = Database::Access::read_only);

  const StoredBuild& build() const { return build_; }
  /// Throws DamagedDatabase if the contents of the file contradict each other. Reads the whole
  /// file.
  void verify();
  /// Returns the latest progress; none if a record was dropped from the journal since.
  std::optional<Progress> progress();
  /// Returns the workers, each with its full id in hexadecimal.
  std::vector<wire::WorkerStatus> servers();
  Counters counters();
  /// True if no work is handed out before `palpate resume`.
  bool paused();
  /// Returns the priorities that were set, by name of the row in a status.
  std::map<std::string, std::int32_t> priorities();
  std::vector<KeptOut> keptOut();
  /// Returns the results that other workers solve again, now or once they are recorded. The value
  /// is true if two results differ.
  std::map<ResultKey, bool> checks();

 protected:
  explicit StoredTables(Database database) : database_(std::move(database)) {}
  /// Reads the identity of the build. Throws (bad input) if the tables are not Palpate's, or of
  /// another version.
  void readBuild();

  Database database_;
  StoredBuild build_;
};

/// The same tables for their only writer, which owns the StateDirectory. No acknowledgement depends
/// on them, so they are not synced with every group: after a power cut they show an earlier moment.
/// Errors of the database are fatal for the scheduler. One thread.
class Tables : public StoredTables {
 public:
  /// Opens the tables in `directory`, or creates them. Throws (bad input) if they belong to another
  /// version or another build; the message names the scene of that build. Damaged tables are
  /// renamed to state.db.damaged and created again.
  Tables(const StateDirectory& directory, const Problem& problem)
      : Tables(directory, problem, problemId(problem)) {}
  /// Opens existing tables of any build.
  explicit Tables(const StateDirectory& directory);

  void writeProgress(const Progress& progress);
  /// Removes the progress. Call before a record is dropped from the journal. Synced on return.
  void forgetProgress();

  /// Rows kept for departed workers without a result: the latest ones.
  static constexpr std::int64_t most_idle_departed = 1000;
  /// Replaces the rows of these workers. Their heard_seconds_ago counts back from now.
  void writeServers(std::span<const wire::WorkerStatus> servers);
  void writeCounters(const Counters& counters);

  /// Hand-outs and deaths recorded for a transition; kept across runs. The tables identify it by
  /// its space and the numbers of its plan.
  using NumberedTransition = std::pair<std::uint32_t, Transition>;
  void writeLosses(const NumberedTransition& which, const Losses& losses);
  std::map<NumberedTransition, Losses> losses();
  /// Removes all losses. Returns the number of transitions that were set aside.
  std::int64_t forgetLosses();

  /// Excludes workers in this and all later runs. Synced on return.
  void keepOut(std::span<const KeptOut> liars);

  /// Synced on return.
  void writePaused(bool paused);
  void writePriority(const std::string& name, std::int32_t priority);

  /// Records a check, which is kept across runs. A disputed check is synced on return, so it also
  /// survives a power cut.
  void writeCheck(const ResultKey& key, bool disputed);
  void forgetCheck(const ResultKey& key);
  /// Returns 32 secret bytes, which only this scheduler knows. They are replaced if damaged tables
  /// lost them.
  std::string secret();

 private:
  Tables(const StateDirectory& directory, const Problem& problem, const ContentId& wanted);
  void create(const Problem& problem, const ContentId& build);
  /// Runs `change` in a transaction that is synced on return. Other changes may be lost in a power
  /// cut.
  void durably(const std::function<void()>& change);
};

/// Renames damaged tables to state.db.damaged, replacing an older one, so that new tables are
/// created. Throws if that fails.
void putTablesAside(const StateDirectory& directory);

}  // namespace palpate
