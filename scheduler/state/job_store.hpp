#pragma once

#include "proto/palpate.pb.h"
#include "scheduler/plan/leases.hpp"
#include "scheduler/plan/space_plan.hpp"
#include "scheduler/state/journal.hpp"
#include "scheduler/state/sqlite.hpp"
#include "scheduler/state/state_directory.hpp"

namespace palpate {

/// What a state directory is about.
struct StoredBuild {
  ContentId build;
  std::string scene_name;
  std::string problem;        ///< encodeProblem
  std::string kernel_family;  ///< of the results; empty before the first
  bool complete = false;
};

/// The id of a result's nodal fields; all zero of a failure.
ContentId fieldsOf(const wire::Result& result);

/// One recorded result: its header exactly as the worker sent it, and where header and payload lie
/// in the journal.
struct StoredResult {
  TransitionKey key;
  wire::Result header;
  Outcome outcome;  ///< of the header; without fields
  JournalPosition where;
};

/// Counters of a build by name (docs/state.md).
using Counters = std::map<std::string, std::int64_t>;

/// The tables of a build (SQLite, docs/state.md) for reading: results, servers, counters. Opened by
/// name they are a snapshot of the moment of construction, also while a scheduler writes them. One
/// thread.
class StoredTables {
 public:
  static constexpr int schema_version = 3;

  /// Error (bad input) when `directory` is not a state directory, or that of another version.
  explicit StoredTables(const std::filesystem::path& directory);

  const StoredBuild& build() const { return build_; }
  /// Every result, in the order of recording.
  std::vector<StoredResult> results();
  /// The workers, each named by its whole id in hexadecimal.
  std::vector<wire::WorkerStatus> servers();
  Counters counters();

 protected:
  StoredTables(const std::filesystem::path& file, Database::Access access)
      : database_(file, access) {}
  /// Error (bad input) when the tables are not ours, or of another version.
  void readBuild();

  Database database_;
  StoredBuild build_;
};

/// The same tables, and the configurations that results make, for their one writer, which owns the
/// StateDirectory.
///
/// record() is the only way a result gets in, and it is all or nothing: rows and the journal's end
/// in one transaction that has reached the disk when it returns. Errors of the database are fatal
/// for the scheduler. One thread.
class JobStore : public StoredTables {
 public:
  /// Opens the tables in `directory`, or makes them with every point of the uniform lattice
  /// unknown. `problem_bytes` is encodeProblem(problem). Error (bad input) when they belong to
  /// another build, naming its scene, or to another version of them.
  JobStore(const StateDirectory& directory, const Problem& problem,
           const std::string& problem_bytes);

  /// Where the committed journal ends; Journal truncates there.
  JournalEnd committed();

  /// Records results that `journal_end` covers and that the journal has synced; those that
  /// converged become the configurations of their points. Error when a key is recorded already.
  void record(std::span<const StoredResult> results, JournalEnd journal_end);
  /// The end of the build: every point as its plan leaves it. `plans`: one per active node.
  void complete(std::span<const SpacePlan> plans);

  /// Replaces the rows of these workers, heard_seconds_ago as of now.
  void writeServers(std::span<const wire::WorkerStatus> servers);
  void writeCounters(const Counters& counters);

  /// The result with this key; nothing when it is not recorded.
  std::optional<StoredResult> find(const TransitionKey& key);

 private:
  /// Compiled once, since they run for every result.
  struct Prepared {
    explicit Prepared(Database& database);
    Statement put_meta, write_point, insert_result, find_result;
  };

  void create(const Problem& problem, const std::string& problem_bytes);
  void putJournalEnd(JournalEnd end);
  void insert(const StoredResult& result);
  void writePoint(std::size_t space, std::int32_t number, const LatticePoint& position,
                  const PointRecord& point);

  double max_force_;                  ///< N, beyond which a point is terminating
  std::optional<Prepared> prepared_;  ///< once the tables are there
};

}  // namespace palpate
