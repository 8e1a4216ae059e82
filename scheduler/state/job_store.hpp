#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/problem/problem.hpp"
#include "common/space/configuration.hpp"
#include "common/space/space_table.hpp"
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

/// A row of the table of servers.
struct ServerRow {
  std::string worker;  ///< hexadecimal
  std::string host;
  std::uint32_t pid = 0;
  std::string kernel_family;
  std::string state;        ///< "idle", "busy", "lost" or "left"
  double heard_before = 0;  ///< s since the last message
  std::int64_t results = 0;
};

/// The tables of a build (SQLite, docs/state.md): results, the configurations they make, servers,
/// counters. One writer, which owns the StateDirectory; readers open StoredTables beside it at any
/// time.
///
/// record() is the only way a result gets in, and it is all or nothing: rows and the journal's end
/// in one transaction that has reached the disk when it returns. Errors of the database are fatal
/// for the scheduler. One thread.
class JobStore {
 public:
  static constexpr int schema_version = 3;

  /// Opens the tables in `directory`, or makes them with every point of the uniform lattice
  /// unknown. Tables of an older version are made anew from the results in them. Error (bad input)
  /// when they belong to another build, naming its scene, or to a newer version of Palpate.
  JobStore(const StateDirectory& directory, const Problem& problem,
           const std::string& problem_bytes);

  /// Where the committed journal ends; Journal truncates there.
  JournalEnd committed();
  const StoredBuild& build() const { return build_; }

  /// Records results that `journal_end` covers and that the journal has synced; those that
  /// converged become the configurations of their points. Error when a key is recorded already.
  void record(std::span<const StoredResult> results, JournalEnd journal_end);
  /// The end of the build: every point as its plan leaves it. `plans`: one per active node.
  void complete(std::span<const SpacePlan> plans);

  void writeServers(std::span<const ServerRow> servers);
  void writeCounters(const std::map<std::string, std::int64_t>& counters);
  std::map<std::string, std::int64_t> counters();

  /// The result with this key; nothing when it is not recorded.
  std::optional<StoredResult> find(const TransitionKey& key);
  /// Every result, in the order of recording.
  std::vector<StoredResult> results();

 private:
  /// Compiled once, since they run for every result.
  struct Prepared {
    explicit Prepared(Database& database);
    Statement put_meta, write_point, insert_result, find_result;
  };

  void create(const Problem& problem, const std::string& problem_bytes);
  void upgrade(const Problem& problem);
  void makeTables(const Problem& problem);
  void putJournalEnd(JournalEnd end);
  void insert(const StoredResult& result);
  void writePoint(std::size_t space, std::int32_t number, const LatticePoint& position,
                  const PointRecord& point);

  double max_force_;  ///< N, beyond which a point is terminating
  Database database_;
  std::optional<Prepared> prepared_;  ///< once the tables are there
  StoredBuild build_;
};

/// The tables of a state directory, read-only, also while a scheduler writes them: a snapshot of
/// the moment of construction. Those of older versions are read too.
class StoredTables {
 public:
  /// Error (bad input) when `directory` is not a state directory, or that of a newer version.
  explicit StoredTables(const std::filesystem::path& directory);

  const StoredBuild& build() const { return build_; }
  std::vector<StoredResult> results();
  std::vector<ServerRow> servers();
  std::map<std::string, std::int64_t> counters();

 private:
  Database database_;
  StoredBuild build_;
};

}  // namespace palpate
