#include "scheduler/state/job_store.hpp"

#include <tuple>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/program.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

/// "PLPT", so that file(1) and we know the database for ours.
constexpr std::int64_t application_id = 0x504c5054;

/// `header` is a result as it came, to the last bit (SQLite would turn -0.0 into 0); the other
/// columns of a result are its key and what people look for. Nothing is read back from spaces and
/// configurations: they are there for people.
constexpr const char* schema = R"sql(
CREATE TABLE IF NOT EXISTS meta (key TEXT PRIMARY KEY, value ANY) STRICT;
CREATE TABLE IF NOT EXISTS counters (name TEXT PRIMARY KEY, value INTEGER NOT NULL) STRICT;
CREATE TABLE IF NOT EXISTS servers (
  worker TEXT PRIMARY KEY, host TEXT NOT NULL, pid INTEGER NOT NULL, kernel_family TEXT NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('idle', 'busy', 'lost', 'left')),
  heard_at REAL NOT NULL, results INTEGER NOT NULL) STRICT;
CREATE TABLE results (
  space INTEGER, target INTEGER, parent INTEGER, cause TEXT NOT NULL, header BLOB NOT NULL,
  segment INTEGER NOT NULL, offset INTEGER NOT NULL, length INTEGER NOT NULL,
  PRIMARY KEY (space, target, parent)) STRICT;
CREATE TABLE spaces (space INTEGER PRIMARY KEY, name TEXT NOT NULL) STRICT;
CREATE TABLE configurations (
  space INTEGER, point INTEGER, i INTEGER NOT NULL, j INTEGER NOT NULL, k INTEGER NOT NULL,
  tag TEXT NOT NULL CHECK (tag IN ('unknown', 'expandable', 'terminating', 'failed')),
  cause TEXT NOT NULL, parent INTEGER NOT NULL, force REAL, factorizations INTEGER NOT NULL,
  PRIMARY KEY (space, point)) STRICT, WITHOUT ROWID;
)sql";

/// In the order of the columns that readResult() takes.
const std::string select_results =
    "SELECT space, target, parent, header, segment, offset, length FROM results ";

std::int64_t pragma(Database& database, const std::string& name) {
  Statement query(database, "PRAGMA " + name);
  return query.step() ? query.integer(0) : 0;
}

template <class Value = std::string>
Value meta(Database& database, const std::string& key) {
  Statement query(database, "SELECT value FROM meta WHERE key = ?");
  if (!query.bind(key).step()) return Value();
  if constexpr (std::is_integral_v<Value>)
    return query.integer<Value>(0);
  else
    return query.text(0);
}

void checkVersion(Database& database) {
  const std::string file = database.file().string();
  if (pragma(database, "application_id") != application_id)
    throw badInput("{}: is a database, but not one of Palpate's", file);
  const std::int64_t found = pragma(database, "user_version");
  const std::string_view age = found > JobStore::schema_version ? "newer" : "older";
  if (found != JobStore::schema_version)
    throw badInput(
        "{}: was made by {} {} Palpate (state version {}, "
        "this is palpate {} with state version {}): go on with the {} one, "
        "or use another --state directory",
        file, age == "older" ? "an" : "a", age, found, version(), JobStore::schema_version, age);
}

StoredResult readResult(const Statement& row) {
  StoredResult result;
  if (!result.header.ParseFromString(row.text(3)))
    throw failure("the state database holds a damaged result");
  auto outcome = fromWire(result.header);
  if (!outcome) throw failure("the state database holds a result that makes no sense");
  using Number = std::int32_t;
  result.key = {row.integer<std::uint32_t>(0), row.integer<Number>(1), row.integer<Number>(2)};
  result.outcome = std::move(*outcome);
  result.where = {row.integer<std::uint32_t>(4), row.integer<std::uint64_t>(5),
                  row.integer<std::uint64_t>(6)};
  return result;
}

std::filesystem::path existingDatabase(const std::filesystem::path& directory) {
  std::filesystem::path file = StateDirectory::databaseIn(directory);
  if (!std::filesystem::exists(file))
    throw badInput("{}: is not a state directory of Palpate: there is no {} in it",
                   directory.string(), file.filename().string());
  return file;
}

bool covers(const JournalEnd& end, const JournalPosition& where) {
  return std::tuple(where.segment, where.offset + where.length) <=
         std::tuple(end.segment, end.offset);
}

}  // namespace

ContentId fieldsOf(const wire::Result& result) {
  return ContentId::fromBytes(result.fields_id()).value_or(ContentId());
}

JobStore::Prepared::Prepared(Database& database)
    : put_meta(database, "INSERT OR REPLACE INTO meta VALUES (?, ?)"),
      write_point(database,
                  "INSERT OR REPLACE INTO configurations VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"),
      insert_result(database, "INSERT OR IGNORE INTO results VALUES (?, ?, ?, ?, ?, ?, ?, ?)"),
      find_result(database, select_results + "WHERE space = ? AND target = ? AND parent = ?") {}

JobStore::JobStore(const StateDirectory& directory, const Problem& problem,
                   const std::string& problem_bytes)
    : StoredTables(directory.database(), Database::Access::read_write_create),
      max_force_(problem.scene.workspace.max_force) {
  // FULL: in WAL mode a commit is otherwise synced only at the next checkpoint, and an acknowledged
  // result could vanish with the power.
  database_.execute(
      "PRAGMA page_size = 8192; PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL");
  if (pragma(database_, "schema_version") == 0) create(problem, problem_bytes);
  readBuild();
  const ContentId wanted = problemId(problem);
  if (build_.build != wanted)
    throw badInput(
        "{}: holds build {} of scene \"{}\", "
        "but this is build {} of scene \"{}\" (scene or mesh changed): "
        "use another --state directory, or remove that one if its results are not needed",
        directory.path().string(), build_.build.shortHex(), build_.scene_name, wanted.shortHex(),
        problem.scene.name);
  if (!prepared_) prepared_.emplace(database_);
}

void JobStore::create(const Problem& problem, const std::string& problem_bytes) {
  // All or nothing: a database without its meta would belong to no build.
  inTransaction(database_, [&] {
    database_.execute(schema);
    database_.execute(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}",
                                  application_id, schema_version));
    prepared_.emplace(database_);  // SQLite compiles statements against tables that are there
    Statement add_space(database_, "INSERT INTO spaces VALUES (?, ?)");
    for (std::size_t space = 0; space < problem.active.size(); ++space) {
      const Lattice lattice = uniformLattice(problem.scene, problem.active[space]);
      add_space.run(space, problem.active[space].name);
      for (std::int32_t n = 0; n < lattice.size(); ++n) writePoint(space, n, lattice.point(n), {});
    }
    prepared_->put_meta.run("build", problemId(problem).hex());
    prepared_->put_meta.run("scene_name", problem.scene.name);
    prepared_->put_meta.run("problem", Blob{problem_bytes});
    prepared_->put_meta.run("made_by", std::string("palpate ") + version());
    putJournalEnd({});
  });
}

JournalEnd JobStore::committed() {
  return {meta<std::uint32_t>(database_, "journal_segment"),
          meta<std::uint64_t>(database_, "journal_offset")};
}

void JobStore::putJournalEnd(JournalEnd end) {
  prepared_->put_meta.run("journal_segment", end.segment);
  prepared_->put_meta.run("journal_offset", end.offset);
}

void JobStore::record(std::span<const StoredResult> results, JournalEnd journal_end) {
  const std::string family =
      results.empty() ? build_.kernel_family : results.front().header.kernel_family();
  inTransaction(database_, [&] {
    for (const StoredResult& result : results) {
      PALPATE_ASSERT(covers(journal_end, result.where),
                     "the journal is cut off at its end, and no row may point behind it");
      insert(result);
    }
    if (family != build_.kernel_family) prepared_->put_meta.run("kernel_family", family);
    putJournalEnd(journal_end);
  });
  build_.kernel_family = family;
}

void JobStore::insert(const StoredResult& result) {
  const auto& [key, header, outcome, where] = result;
  prepared_->insert_result.run(key.space, key.target, key.parent, name(outcome.failure.cause),
                               Blob{header.SerializeAsString()}, where.segment, where.offset,
                               where.length);
  // The key is there already, and OR IGNORE left the first result as it is.
  if (database_.changes() == 0)
    throw failure("{}: point {} of space {} is recorded twice from point {}",
                  database_.file().string(), key.target, key.space, key.parent);
  if (outcome.converged)
    writePoint(key.space, key.target, fromWire(header.target()),
               solvedPoint(key.parent, outcome, fieldsOf(header), max_force_));
}

void JobStore::writePoint(std::size_t space, std::int32_t number, const LatticePoint& position,
                          const PointRecord& point) {
  const double force = isSolved(point.tag) ? point.equilibrium.force.norm()
                                           : std::numeric_limits<double>::quiet_NaN();
  prepared_->write_point.run(space, number, position[0], position[1], position[2], name(point.tag),
                             name(point.cause), point.parent, force, point.cost.factorizations);
}

void JobStore::complete(std::span<const SpacePlan> plans) {
  inTransaction(database_, [&] {
    for (std::size_t space = 0; space < plans.size(); ++space) {
      PALPATE_ASSERT(plans[space].complete(), "a build ends with its last space");
      for (std::int32_t n = 0; n < plans[space].size(); ++n)
        writePoint(space, n, plans[space].positions().point(n), plans[space].point(n));
    }
    prepared_->put_meta.run("complete", 1);
  });
  build_.complete = true;
}

void JobStore::writeServers(std::span<const wire::WorkerStatus> servers) {
  inTransaction(database_, [&] {
    Statement insert(database_,
                     "INSERT OR REPLACE INTO servers VALUES (?, ?, ?, ?, ?, "
                     "(julianday('now') - 2440587.5) * 86400.0 - ?, ?)");
    for (const wire::WorkerStatus& row : servers)
      insert.run(row.worker(), row.host(), row.pid(), row.kernel_family(), row.state(),
                 row.heard_seconds_ago(), row.results());
  });
}

void JobStore::writeCounters(const Counters& counters) {
  inTransaction(database_, [&] {
    Statement insert(database_, "INSERT OR REPLACE INTO counters VALUES (?, ?)");
    for (const auto& [name, value] : counters) insert.run(name, value);
  });
}

std::optional<StoredResult> JobStore::find(const TransitionKey& key) {
  Statement& query = prepared_->find_result;
  std::optional<StoredResult> found;
  if (query.bind(key.space, key.target, key.parent).step()) found = readResult(query);
  // The statement lives on, and an open query would keep the write-ahead log from being folded back
  // into the database.
  query.reset();
  return found;
}

StoredTables::StoredTables(const std::filesystem::path& directory)
    : StoredTables(existingDatabase(directory), Database::Access::read_only) {
  // Left open: everything is read as of now, whatever the scheduler writes meanwhile.
  database_.execute("BEGIN");
  readBuild();
}

void StoredTables::readBuild() {
  checkVersion(database_);
  const auto build = ContentId::fromHex(meta(database_, "build"));
  if (!build) throw failure("{}: damaged: no build id in it", database_.file().string());
  build_ = {*build, meta(database_, "scene_name"), meta(database_, "problem"),
            meta(database_, "kernel_family"), meta<int>(database_, "complete") != 0};
}

std::vector<StoredResult> StoredTables::results() {
  std::vector<StoredResult> results;
  Statement query(database_, select_results + "ORDER BY rowid");
  while (query.step()) results.push_back(readResult(query));
  return results;
}

std::vector<wire::WorkerStatus> StoredTables::servers() {
  std::vector<wire::WorkerStatus> rows;
  Statement query(database_,
                  "SELECT worker, host, pid, kernel_family, state, "
                  "(julianday('now') - 2440587.5) * 86400.0 - heard_at, results "
                  "FROM servers ORDER BY host, pid");
  while (query.step()) {
    wire::WorkerStatus& row = rows.emplace_back();
    row.set_worker(query.text(0));
    row.set_host(query.text(1));
    row.set_pid(query.integer<std::uint32_t>(2));
    row.set_kernel_family(query.text(3));
    row.set_state(query.text(4));
    row.set_heard_seconds_ago(query.real(5));
    row.set_results(query.integer<std::int32_t>(6));
  }
  return rows;
}

Counters StoredTables::counters() {
  Counters counters;
  Statement query(database_, "SELECT name, value FROM counters");
  while (query.step()) counters[query.text(0)] = query.integer(1);
  return counters;
}

}  // namespace palpate
