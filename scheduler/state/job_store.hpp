#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/problem/problem.hpp"
#include "common/space/configuration.hpp"
#include "common/space/lattice.hpp"
#include "proto/palpate.pb.h"
#include "scheduler/plan/frontier.hpp"
#include "scheduler/plan/leases.hpp"
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
  double heard_at = 0;      ///< Unix time of it; filled on reading
  std::int64_t results = 0;
};

struct FailedPoint {
  LatticePoint position;
  Cause cause = Cause::none;
};
/// The failed points of one space by number.
using FailedPoints = std::map<std::int32_t, FailedPoint>;

/// The tables of a build (SQLite, docs/state.md): servers, configurations, attempts, counters. One
/// writer, which owns the StateDirectory; readers open StoredTables beside it at any time.
///
/// record() is the only way a result gets in, and it is all or nothing: rows, counters and the
/// journal's end in one transaction that has reached the disk when it returns. Errors of the
/// database are fatal for the scheduler.
class JobStore {
 public:
  static constexpr int schema_version = 2;

  /// Opens the tables in `directory`, or makes them with every point of the uniform lattice
  /// unknown. Error (bad input) when they belong to another build, naming its scene, or to a newer
  /// version of Palpate.
  JobStore(const StateDirectory& directory, const Problem& problem,
           const std::string& problem_bytes);

  /// Where the committed journal ends; Journal truncates there.
  JournalEnd committed();
  const StoredBuild& build() const { return build_; }

  /// Records results that `journal_end` covers and that the journal has synced. The first converged
  /// one of a point becomes its row, with the tag that `tags` (parallel to results) gives; failed
  /// ones, and those that converged for a point that has its row, become attempts. Error when a key
  /// is recorded already.
  void record(std::span<const StoredResult> results, std::span<const Tag> tags,
              JournalEnd journal_end);
  void setKernelFamily(const std::string& family);
  /// The end of the build: the points of each space that could not be reached.
  void complete(std::span<const FailedPoints> failed);

  void writeServers(std::span<const ServerRow> servers);
  void writeCounters(const std::map<std::string, std::int64_t>& counters);
  std::map<std::string, std::int64_t> counters();

  /// The result with this key; nothing when it is not recorded.
  std::optional<StoredResult> find(const TransitionKey& key);
  /// Every result: first those that made a row of a point, by (space, point), then the others by
  /// (space, target, order of trying).
  std::vector<StoredResult> results();

 private:
  void create(const Problem& problem, const std::string& problem_bytes);
  void upgrade();
  void insertAttempt(const StoredResult& result);
  bool makeRow(const StoredResult& result, Tag tag);

  Database database_;
  StoredBuild build_;
};

/// The tables of a state directory, read-only, also while a scheduler writes them: a snapshot of
/// the moment of construction.
class StoredTables {
 public:
  /// Error (bad input) when `directory` is not a state directory of this version.
  explicit StoredTables(const std::filesystem::path& directory);
  ~StoredTables();

  const StoredBuild& build() const { return build_; }
  std::vector<StoredResult> results();
  std::vector<ServerRow> servers();
  std::map<std::string, std::int64_t> counters();

 private:
  Database database_;
  StoredBuild build_;
};

}  // namespace palpate
