#include "scheduler/state/job_store.hpp"

#include "common/base/error.hpp"
#include "common/base/program.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

constexpr std::int64_t application_id =
    0x504c5054;  // "PLPT", so that file(1) and we know the database for ours

/// Columns are for people and SQL; `header` is the result as it came, to the last bit.
constexpr const char* schema = R"sql(
CREATE TABLE meta (key TEXT PRIMARY KEY, value ANY) STRICT;
CREATE TABLE spaces (space INTEGER PRIMARY KEY, name TEXT NOT NULL, node INTEGER NOT NULL) STRICT;
CREATE TABLE servers (worker TEXT PRIMARY KEY, host TEXT NOT NULL, pid INTEGER NOT NULL, kernel_family TEXT NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('idle', 'busy', 'lost', 'left')), heard_at REAL NOT NULL,
  results INTEGER NOT NULL) STRICT;
CREATE TABLE configurations (space INTEGER, point INTEGER, i INTEGER NOT NULL, j INTEGER NOT NULL, k INTEGER NOT NULL,
  tag TEXT NOT NULL CHECK (tag IN ('unknown', 'expandable', 'terminating', 'failed')), cause TEXT, parent INTEGER,
  force_x REAL, force_y REAL, force_z REAL, energy REAL, min_det_f REAL,
  newton_iterations INTEGER, factorizations INTEGER, steps INTEGER, seconds REAL, fields_id BLOB,
  header BLOB, segment INTEGER, offset INTEGER, length INTEGER,
  PRIMARY KEY (space, point)) STRICT, WITHOUT ROWID;
CREATE TABLE attempts (space INTEGER, target INTEGER, number INTEGER, parent INTEGER NOT NULL, cause TEXT NOT NULL,
  step_reached REAL, residual REAL, element INTEGER, element_det_f REAL, negative_pivots INTEGER,
  expected_negative_pivots INTEGER, mumps_infog1 INTEGER, mumps_infog2 INTEGER, newton_iterations INTEGER,
  seconds REAL, header BLOB NOT NULL, segment INTEGER NOT NULL, offset INTEGER NOT NULL, length INTEGER NOT NULL,
  PRIMARY KEY (space, target, number), UNIQUE (space, target, parent)) STRICT, WITHOUT ROWID;
CREATE TABLE counters (name TEXT PRIMARY KEY, value INTEGER NOT NULL) STRICT;
)sql";

// The number of the target is called point in one table and target in the other.
constexpr const char* result_columns = "header, segment, offset, length, parent";

std::int64_t pragma(Database& database, const std::string& name) {
  Statement query(database, "PRAGMA " + name);
  return query.step() ? query.integer(0) : 0;
}

void putMeta(Database& database, const std::string& key, std::string_view value,
             bool binary = false) {
  Statement insert(database, "INSERT OR REPLACE INTO meta VALUES (?, ?)");
  insert.bindText(1, key);
  if (binary)
    insert.bindBlob(2, value);
  else
    insert.bindText(2, value);
  insert.run();
}

std::string meta(Database& database, const std::string& key) {
  Statement query(database, "SELECT value FROM meta WHERE key = ?");
  query.bindText(1, key);
  return query.step() ? query.blob(0) : std::string();
}

std::int64_t metaNumber(Database& database, const std::string& key) {
  Statement query(database, "SELECT value FROM meta WHERE key = ?");
  query.bindText(1, key);
  return query.step() ? query.integer(0) : 0;
}

void putMetaNumber(Database& database, const std::string& key, std::int64_t value) {
  Statement insert(database, "INSERT OR REPLACE INTO meta VALUES (?, ?)");
  insert.bindText(1, key).bind(2, value).run();
}

StoredBuild readBuild(Database& database) {
  const auto build = ContentId::fromHex(meta(database, "build"));
  if (!build) throw failure("{}: damaged: no build id in it", database.file().string());
  return {*build, meta(database, "scene_name"), meta(database, "problem"),
          meta(database, "kernel_family"), metaNumber(database, "complete") != 0};
}

void checkVersion(Database& database) {
  const std::string file = database.file().string();
  if (pragma(database, "application_id") != application_id)
    throw badInput("{}: is a database, but not one of Palpate's", file);
  const std::int64_t found = pragma(database, "user_version");
  if (found > JobStore::schema_version)
    throw badInput(
        "{}: was made by a newer Palpate (state version {}, "
        "this is palpate {} with state version {}): go on with the newer one, "
        "or use another --state directory",
        file, found, version(), JobStore::schema_version);
}

StoredResult readResult(Statement& row) {
  StoredResult result;
  if (!result.header.ParseFromString(row.blob(0)))
    throw failure("the state database holds a damaged result");
  auto outcome = fromWire(result.header);
  if (!outcome) throw failure("the state database holds a result that makes no sense");
  result.key = {result.header.space(), static_cast<std::int32_t>(row.integer(5)),
                static_cast<std::int32_t>(row.integer(4))};
  result.outcome = std::move(*outcome);
  result.where = {static_cast<std::uint32_t>(row.integer(1)),
                  static_cast<std::uint64_t>(row.integer(2)),
                  static_cast<std::uint64_t>(row.integer(3))};
  return result;
}

std::vector<StoredResult> readResults(Database& database) {
  std::vector<StoredResult> results;
  Statement solved(
      database,
      fmt::format(
          "SELECT {}, point FROM configurations WHERE header IS NOT NULL ORDER BY space, point",
          result_columns));
  while (solved.step()) results.push_back(readResult(solved));
  Statement failed(database,
                   fmt::format("SELECT {}, target FROM attempts ORDER BY space, target, number",
                               result_columns));
  while (failed.step()) results.push_back(readResult(failed));
  return results;
}

std::map<std::string, std::int64_t> readCounters(Database& database) {
  std::map<std::string, std::int64_t> counters;
  Statement query(database, "SELECT name, value FROM counters");
  while (query.step()) counters[query.text(0)] = query.integer(1);
  return counters;
}

}  // namespace

/// Version 1 knew the uniform lattice alone: what was complete then may have branches and probes to
/// solve.
void JobStore::upgrade() {
  Transaction transaction(database_);
  putMetaNumber(database_, "complete", 0);
  database_.execute(fmt::format("PRAGMA user_version = {}", schema_version));
  transaction.commit();
}

ContentId fieldsOf(const wire::Result& result) {
  return ContentId::fromBytes(result.fields_id()).value_or(ContentId());
}

JobStore::JobStore(const StateDirectory& directory, const Problem& problem,
                   const std::string& problem_bytes)
    : database_(directory.database(), Database::Access::read_write_create) {
  database_.execute(
      "PRAGMA page_size = 8192; PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL");
  if (pragma(database_, "schema_version") == 0) create(problem, problem_bytes);
  checkVersion(database_);
  if (pragma(database_, "user_version") < schema_version) upgrade();
  build_ = readBuild(database_);
  const ContentId wanted = problemId(problem);
  if (build_.build != wanted)
    throw badInput(
        "{}: holds build {} of scene \"{}\", "
        "but this is build {} of scene \"{}\" (scene or mesh changed): "
        "use another --state directory, or remove that one if its results are not needed",
        directory.path().string(), build_.build.shortHex(), build_.scene_name, wanted.shortHex(),
        problem.scene.name);
}

void JobStore::create(const Problem& problem, const std::string& problem_bytes) {
  const Lattice lattice = uniformLattice(problem.scene);
  Transaction transaction(database_);
  database_.execute(schema);
  database_.execute(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}",
                                application_id, schema_version));
  putMeta(database_, "build", problemId(problem).hex());
  putMeta(database_, "scene_name", problem.scene.name);
  putMeta(database_, "problem", problem_bytes, true);
  putMeta(database_, "made_by", std::string("palpate ") + version());
  putMetaNumber(database_, "journal_segment", JournalEnd().segment);
  putMetaNumber(database_, "journal_offset", 0);
  Statement space(database_, "INSERT INTO spaces VALUES (?, ?, ?)");
  Statement point(
      database_,
      "INSERT INTO configurations (space, point, i, j, k, tag) VALUES (?, ?, ?, ?, ?, 'unknown')");
  for (std::size_t s = 0; s < problem.active.size(); ++s) {
    const auto number = static_cast<std::int64_t>(s);
    space.bind(1, number)
        .bindText(2, problem.active[s].name)
        .bind(3, std::int64_t{problem.active[s].node})
        .run();
    for (std::int32_t n = 0; n < lattice.size(); ++n) {
      point.bind(1, number).bind(2, std::int64_t{n});
      for (int axis = 0; axis < 3; ++axis)
        point.bind(3 + axis, std::int64_t{lattice.point(n)[axis]});
      point.run();
    }
  }
  transaction.commit();
}

JournalEnd JobStore::committed() {
  return {static_cast<std::uint32_t>(metaNumber(database_, "journal_segment")),
          static_cast<std::uint64_t>(metaNumber(database_, "journal_offset"))};
}

void JobStore::record(std::span<const StoredResult> results, std::span<const Tag> tags,
                      JournalEnd journal_end) {
  Transaction transaction(database_);
  for (std::size_t n = 0; n < results.size(); ++n) {
    const TransitionKey& key = results[n].key;
    if (find(key))
      throw failure("{}: point {} of space {} is recorded twice from point {}",
                    database_.file().string(), key.target, key.space, key.parent);
    if (!results[n].outcome.converged || !makeRow(results[n], tags[n])) insertAttempt(results[n]);
  }
  putMetaNumber(database_, "journal_segment", journal_end.segment);
  putMetaNumber(database_, "journal_offset", static_cast<std::int64_t>(journal_end.offset));
  transaction.commit();
}

/// False when the point has its row already.
bool JobStore::makeRow(const StoredResult& result, Tag tag) {
  Statement update(
      database_,
      "INSERT INTO configurations (tag, parent, force_x, force_y, force_z, energy, min_det_f, "
      "newton_iterations, factorizations, steps, seconds, fields_id, header, segment, offset, "
      "length, space, "
      "point, i, j, k) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) "
      "ON CONFLICT (space, point) DO UPDATE SET tag = excluded.tag, parent = excluded.parent, "
      "force_x = excluded.force_x, force_y = excluded.force_y, force_z = excluded.force_z, "
      "energy = excluded.energy, min_det_f = excluded.min_det_f, "
      "newton_iterations = excluded.newton_iterations, factorizations = excluded.factorizations, "
      "steps = excluded.steps, seconds = excluded.seconds, fields_id = excluded.fields_id, "
      "header = excluded.header, segment = excluded.segment, offset = excluded.offset, "
      "length = excluded.length WHERE configurations.header IS NULL");
  const Equilibrium& equilibrium = result.outcome.equilibrium;
  const Cost& cost = result.outcome.cost;
  update.bindText(1, name(tag)).bind(2, std::int64_t{result.key.parent});
  for (int axis = 0; axis < 3; ++axis) update.bind(3 + axis, equilibrium.force[axis]);
  update.bind(6, equilibrium.energy).bind(7, equilibrium.min_det_F);
  update.bind(8, std::int64_t{cost.newton_iterations}).bind(9, std::int64_t{cost.factorizations});
  update.bind(10, std::int64_t{cost.steps})
      .bind(11, cost.seconds)
      .bindBlob(12, result.header.fields_id());
  update.bindBlob(13, result.header.SerializeAsString())
      .bind(14, std::int64_t{result.where.segment});
  update.bind(15, static_cast<std::int64_t>(result.where.offset));
  update.bind(16, static_cast<std::int64_t>(result.where.length));
  update.bind(17, std::int64_t{result.key.space}).bind(18, std::int64_t{result.key.target});
  const LatticePoint position = fromWire(result.header.target());
  for (int axis = 0; axis < 3; ++axis) update.bind(19 + axis, std::int64_t{position[axis]});
  update.run();
  return database_.changes() == 1;
}

void JobStore::insertAttempt(const StoredResult& result) {
  Statement insert(
      database_,
      "INSERT INTO attempts SELECT ?1, ?2, COALESCE(MAX(number) + 1, 0), ?3, ?4, ?5, ?6, ?7, ?8, "
      "?9, ?10, "
      "?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18 FROM attempts WHERE space = ?1 AND target = ?2");
  const Failure& f = result.outcome.failure;
  insert.bind(1, std::int64_t{result.key.space}).bind(2, std::int64_t{result.key.target});
  insert.bind(3, std::int64_t{result.key.parent})
      .bindText(4, name(f.cause))
      .bind(5, f.step_reached);
  insert.bind(6, f.residual).bind(7, std::int64_t{f.element}).bind(8, f.element_det_F);
  insert.bind(9, std::int64_t{f.negative_pivots})
      .bind(10, std::int64_t{f.expected_negative_pivots});
  insert.bind(11, std::int64_t{f.mumps_infog1}).bind(12, std::int64_t{f.mumps_infog2});
  insert.bind(13, std::int64_t{result.outcome.cost.newton_iterations})
      .bind(14, result.outcome.cost.seconds);
  insert.bindBlob(15, result.header.SerializeAsString())
      .bind(16, std::int64_t{result.where.segment});
  insert.bind(17, static_cast<std::int64_t>(result.where.offset));
  insert.bind(18, static_cast<std::int64_t>(result.where.length));
  insert.run();
}

void JobStore::setKernelFamily(const std::string& family) {
  putMeta(database_, "kernel_family", family);
  build_.kernel_family = family;
}

void JobStore::complete(std::span<const FailedPoints> failed) {
  Transaction transaction(database_);
  Statement update(
      database_,
      "INSERT INTO configurations (tag, cause, space, point, i, j, k) "
      "VALUES ('failed', ?, ?, ?, ?, ?, ?) "
      "ON CONFLICT (space, point) DO UPDATE SET tag = excluded.tag, cause = excluded.cause");
  for (std::size_t space = 0; space < failed.size(); ++space)
    for (const auto& [number, point] : failed[space]) {
      update.bindText(1, name(point.cause)).bind(2, static_cast<std::int64_t>(space));
      update.bind(3, std::int64_t{number});
      for (int axis = 0; axis < 3; ++axis)
        update.bind(4 + axis, std::int64_t{point.position[axis]});
      update.run();
    }
  putMetaNumber(database_, "complete", 1);
  transaction.commit();
  build_.complete = true;
}

void JobStore::writeServers(std::span<const ServerRow> servers) {
  Transaction transaction(database_);
  Statement insert(database_,
                   "INSERT OR REPLACE INTO servers VALUES (?, ?, ?, ?, ?, "
                   "(julianday('now') - 2440587.5) * 86400.0 - ?, ?)");
  for (const ServerRow& row : servers) {
    insert.bindText(1, row.worker)
        .bindText(2, row.host)
        .bind(3, std::int64_t{row.pid})
        .bindText(4, row.kernel_family);
    insert.bindText(5, row.state).bind(6, row.heard_before).bind(7, row.results).run();
  }
  transaction.commit();
}

void JobStore::writeCounters(const std::map<std::string, std::int64_t>& counters) {
  Transaction transaction(database_);
  Statement insert(database_, "INSERT OR REPLACE INTO counters VALUES (?, ?)");
  for (const auto& [name, value] : counters) insert.bindText(1, name).bind(2, value).run();
  transaction.commit();
}

std::map<std::string, std::int64_t> JobStore::counters() { return readCounters(database_); }

std::optional<StoredResult> JobStore::find(const TransitionKey& key) {
  for (const auto& [table, target] :
       {std::pair{"configurations", "point"}, {"attempts", "target"}}) {
    Statement query(
        database_,
        fmt::format("SELECT {0}, {2} FROM {1} WHERE space = ? AND {2} = ? AND parent = ? "
                    "AND header IS NOT NULL",
                    result_columns, table, target));
    query.bind(1, std::int64_t{key.space})
        .bind(2, std::int64_t{key.target})
        .bind(3, std::int64_t{key.parent});
    if (query.step()) return readResult(query);
  }
  return std::nullopt;
}

std::vector<StoredResult> JobStore::results() { return readResults(database_); }

namespace {

std::filesystem::path existingDatabase(const std::filesystem::path& directory) {
  std::filesystem::path file = StateDirectory::databaseIn(directory);
  if (!std::filesystem::exists(file))
    throw badInput("{}: is not a state directory of Palpate: there is no {} in it",
                   directory.string(), file.filename().string());
  return file;
}

}  // namespace

StoredTables::StoredTables(const std::filesystem::path& directory)
    : database_(existingDatabase(directory), Database::Access::read_only) {
  database_.execute("BEGIN");
  checkVersion(database_);
  build_ = readBuild(database_);
}

StoredTables::~StoredTables() = default;

std::vector<StoredResult> StoredTables::results() { return readResults(database_); }

std::vector<ServerRow> StoredTables::servers() {
  std::vector<ServerRow> rows;
  Statement query(
      database_,
      "SELECT worker, host, pid, kernel_family, state, heard_at, results, "
      "(julianday('now') - 2440587.5) * 86400.0 - heard_at FROM servers ORDER BY host, pid");
  while (query.step())
    rows.push_back({query.text(0), query.text(1), static_cast<std::uint32_t>(query.integer(2)),
                    query.text(3), query.text(4), query.real(7), query.real(5), query.integer(6)});
  return rows;
}

std::map<std::string, std::int64_t> StoredTables::counters() { return readCounters(database_); }

}  // namespace palpate
