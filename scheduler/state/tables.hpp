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

/// What a state directory is about.
struct StoredBuild {
  ContentId build;
  std::string scene_name;
  std::string problem;  ///< encodeProblem
};
/// Its problem; nothing when that is damaged, or not the one of the build id.
std::optional<Problem> problemOf(const StoredBuild& build);

/// How far a build is, as its scheduler says now and then.
struct Progress {
  std::size_t recorded = 0;  ///< results in the journal; it may hold more by now
  std::string status;        ///< for people: a wire::Status as JSON (progressOf)
};

/// Counters of a build by name (docs/state.md).
using Counters = std::map<std::string, std::int64_t>;

/// The tables of a build (SQLite, docs/state.md) for reading. Opened by name they are a snapshot of
/// the moment of construction, also while a scheduler writes them. They hold no result: those are
/// in the journal, and what the tables say of them is for people. One thread.
class StoredTables {
 public:
  static constexpr int schema_version = 6;

  /// Error (bad input) when `directory` is not a state directory, or that of another version. It
  /// need not be writable; with Access::read_untouched nothing in it is
  /// changed.
  explicit StoredTables(const std::filesystem::path& directory,
                        Database::Access access = Database::Access::read_only);

  const StoredBuild& build() const { return build_; }
  /// DamagedDatabase when what is in the file contradicts itself. Reads all of it.
  void verify();
  /// What was written last; nothing when something was dropped from the journal since.
  std::optional<Progress> progress();
  /// The workers, each named by its whole id in hexadecimal.
  std::vector<wire::WorkerStatus> servers();
  Counters counters();
  /// Nothing is handed out before `palpate resume`.
  bool paused();
  /// Of rows of a status, by name; of those that were given one.
  std::map<std::string, std::int32_t> priorities();
  std::vector<KeptOut> keptOut();
  /// Results that others are to solve again, or will be once they are recorded; whether two differ.
  std::map<ResultKey, bool> checks();

 protected:
  explicit StoredTables(Database database) : database_(std::move(database)) {}
  /// Error (bad input) when the tables are not ours, or of another version.
  void readBuild();

  Database database_;
  StoredBuild build_;
};

/// The same tables for their one writer, which owns the StateDirectory. Nothing that an
/// acknowledgement promises rests on them, so they are not synced with every group: after a power
/// cut they are those of some moment before. Errors of the database are fatal for the scheduler.
/// One thread.
class Tables : public StoredTables {
 public:
  /// Opens the tables in `directory`, or makes them. Error (bad input) when they belong to another
  /// build, naming its scene, or to another version. Tables that SQLite finds damaged are put aside
  /// (state.db.damaged) and made anew.
  Tables(const StateDirectory& directory, const Problem& problem)
      : Tables(directory, problem, problemId(problem)) {}
  /// Those that are there, of whichever build.
  explicit Tables(const StateDirectory& directory);

  void writeProgress(const Progress& progress);
  /// Before something is dropped from the journal; synced when it returns.
  void forgetProgress();

  /// Of workers that went without any result, the latest so many keep their rows.
  static constexpr std::int64_t most_idle_departed = 1000;
  /// Replaces the rows of these workers, heard_seconds_ago as of now.
  void writeServers(std::span<const wire::WorkerStatus> servers);
  void writeCounters(const Counters& counters);

  /// What is known of workers that ended while they solved a transition, which outlives a run. The
  /// tables name it by its space and the numbers of its plan.
  using NumberedTransition = std::pair<std::uint32_t, Transition>;
  void writeLosses(const NumberedTransition& which, const Losses& losses);
  std::map<NumberedTransition, Losses> losses();
  /// Returns how many transitions were set aside.
  std::int64_t forgetLosses();

  /// From now on, whatever happens: synced when it returns.
  void keepOut(std::span<const KeptOut> liars);

  /// Synced when they return.
  void writePaused(bool paused);
  void writePriority(const std::string& name, std::int32_t priority);

  /// A check outlives a run; a disputed one is synced when it returns, and outlives a power cut.
  void writeCheck(const ResultKey& key, bool disputed);
  void forgetCheck(const ResultKey& key);
  /// 32 bytes that nobody else knows.
  std::string secret();

 private:
  Tables(const StateDirectory& directory, const Problem& problem, const ContentId& wanted);
  void create(const Problem& problem, const ContentId& build);
  /// As a rule these tables may lose their last moments. Not this: synced when it returns.
  void durably(const std::function<void()>& change);
};

/// Renames damaged tables to state.db.damaged, so that the next ones are made anew; one that is
/// there already is replaced. Error when that cannot be done.
void putTablesAside(const StateDirectory& directory);

}  // namespace palpate
