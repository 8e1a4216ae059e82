#include "scheduler/state/tables.hpp"

#include <fcntl.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>

#include "common/base/bytes32.hpp"
#include "common/base/error.hpp"
#include "common/base/program.hpp"

namespace palpate {
namespace {

/// "PLPT". Identifies the database as Palpate's, also for file(1).
constexpr std::int64_t application_id = 0x504c5054;

/// No result of a build depends on these tables. They are for users, for `palpate status` while no
/// scheduler runs, and for the next run (losses, checks, kept_out, the secret).
constexpr const char* schema = R"sql(
CREATE TABLE meta (key TEXT PRIMARY KEY, value ANY) STRICT;
CREATE TABLE counters (name TEXT PRIMARY KEY, value INTEGER NOT NULL) STRICT;
CREATE TABLE servers (
  worker TEXT PRIMARY KEY, host TEXT NOT NULL, pid INTEGER NOT NULL, kernel_family TEXT NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('idle', 'busy', 'lost', 'left')),
  heard_at REAL NOT NULL, results INTEGER NOT NULL) STRICT;
CREATE TABLE losses (
  space INTEGER, target INTEGER, parent INTEGER, attempts INTEGER NOT NULL, suspected INTEGER NOT NULL,
  deaths INTEGER NOT NULL, PRIMARY KEY (space, target, parent)) STRICT, WITHOUT ROWID;
CREATE TABLE kept_out (
  kind TEXT NOT NULL CHECK (kind IN ('process', 'machine', 'key')), worker BLOB NOT NULL,
  host TEXT NOT NULL, key BLOB NOT NULL, reason TEXT NOT NULL) STRICT;
CREATE TABLE checks (
  space INTEGER, i INTEGER, j INTEGER, k INTEGER, from_i INTEGER, from_j INTEGER, from_k INTEGER,
  disputed INTEGER NOT NULL,
  PRIMARY KEY (space, i, j, k, from_i, from_j, from_k)) STRICT, WITHOUT ROWID;
)sql";

constexpr std::size_t secret_bytes = 32;

/// SQLite's setting for all changes except those of Tables::durably(): a commit is not synced at
/// once.
constexpr const char* synchronous_as_a_rule = "PRAGMA synchronous = NORMAL";

/// Reads a number to which the caller will add. Clamps it, so that numbers in damaged tables cannot
/// overflow.
template <class Number>
Number wholeNumber(const Statement& query, int column) {
  constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max() / 2;
  return static_cast<Number>(std::clamp<std::int64_t>(query.integer(column), 0, most));
}

std::int64_t pragma(Database& database, const std::string& name) {
  Statement query(database, "PRAGMA " + name);
  return query.step() ? query.integer(0) : 0;
}

/// True if nothing was created in the database yet, even if its header claims otherwise.
bool isEmpty(Database& database) {
  Statement objects(database, "SELECT COUNT(*) FROM sqlite_master");
  return objects.step() && objects.integer(0) == 0;
}

std::string meta(Database& database, const std::string& key) {
  Statement query(database, "SELECT value FROM meta WHERE key = ?");
  return query.bind(key).step() ? query.text(0) : "";
}

/// Returns the program that created the tables, according to the table meta; empty if the tables
/// are not Palpate's.
std::string makerOf(Database& database) {
  Statement meta_there(database,
                       "SELECT COUNT(*) FROM sqlite_master WHERE type = 'table' AND name = 'meta'");
  return meta_there.step() && meta_there.integer(0) == 1 ? meta(database, "made_by") : "";
}

template <class Value>
void putMeta(Database& database, const std::string& key, const Value& value) {
  Statement(database, "INSERT OR REPLACE INTO meta VALUES (?, ?)").run(key, value);
}

constexpr std::string_view priority_of = "priority of ";

/// Returns the versions of this program and of its tables. Programs of one version may have
/// different tables.
std::string thisProgram() {
  return fmt::format("palpate {}, state {}", version(), StoredTables::schema_version);
}

/// Throws (bad input) unless the tables are Palpate's and of this version. Throws DamagedDatabase
/// if the file's header and the table meta contradict each other, because then one of them is
/// damaged.
void checkVersion(Database& database) {
  const std::string file = database.file().string();
  const std::string maker = makerOf(database);
  if (pragma(database, "application_id") != application_id) {
    if (maker.starts_with("palpate "))
      throw DamagedDatabase(database.file(), "created by " + maker + ", but marked as foreign");
    throw badInput("{}: is a database of another program", file);
  }
  const std::int64_t found = pragma(database, "user_version");
  if (found != StoredTables::schema_version && maker == thisProgram())
    throw DamagedDatabase(database.file(),
                          fmt::format("created by this program, but with state version {}", found));
  const std::string_view age = found > StoredTables::schema_version ? "newer" : "older";
  if (found != StoredTables::schema_version)
    throw badInput(
        "{}: was created by {} {} Palpate (state version {}; this is palpate {} with state version "
        "{}): continue with the {} version, or use another --state directory",
        file, age == "older" ? "an" : "a", age, found, version(), StoredTables::schema_version,
        age);
}

std::filesystem::path existingDatabase(const std::filesystem::path& directory) {
  std::filesystem::path file = StateDirectory::databaseIn(directory);
  if (!std::filesystem::exists(file))
    throw badInput("{}: is not a state directory of Palpate: it has no {}", directory.string(),
                   file.filename().string());
  return file;
}

/// Throws DamagedDatabase unless the check that `pragma` runs finds the database undamaged.
void requireWhole(Database& database, const char* pragma) {
  Statement check(database, pragma);
  if (!check.step()) throw DamagedDatabase(database.file(), "it cannot be checked");
  if (check.text(0) != "ok") throw DamagedDatabase(database.file(), check.text(0));
}

/// Throws DamagedDatabase if
/// - the pages are inconsistent,
/// - the tables are Palpate's but name no build, or
/// - their build id is not `wanted` and does not match the problem in the tables.
void checkPages(Database& database, const ContentId& wanted) {
  requireWhole(database, "PRAGMA quick_check(1)");
  // SQLite considers a database read-only because of a byte in its header. The file itself is
  // writable, so this byte must be damaged.
  if (database.isReadOnly())
    throw DamagedDatabase(database.file(), "its header says that it is read-only");
  if (isEmpty(database)) return;
  checkVersion(database);
  const auto build = ContentId::fromHex(meta(database, "build"));
  if (!build) throw DamagedDatabase(database.file(), "it has no build id");
  if (*build != wanted && !problemOf({*build, "", meta(database, "problem")}))
    throw DamagedDatabase(database.file(), "its build id does not match its problem");
}

/// Opens the tables in the directory for writing. Damaged tables are first renamed, because the
/// journal has everything that a build needs. If there is no journal, throws the error instead.
Database openForWriting(const StateDirectory& directory, const ContentId& wanted) {
  const std::filesystem::path file = directory.database();
  // SQLite would create the file readable by everybody. SQLite gives its other files the same mode
  // as this one.
  const FileDescriptor mine(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  if (!mine) throw failure("{}: cannot open: {}", file.string(), errnoText());
  try {
    Database database(file, Database::Access::read_write_create);
    checkPages(database, wanted);
    return database;
  } catch (const DamagedDatabase& damage) {
    if (!std::filesystem::exists(directory.path() / "segment-000001.dat")) throw;
    spdlog::warn("{}; it is renamed to {}.damaged and created again, and no result is lost",
                 damage.what(), file.string());
    putTablesAside(directory);
  }
  return {file, Database::Access::read_write_create};
}

}  // namespace

std::optional<Problem> problemOf(const StoredBuild& build) {
  try {
    Problem problem = decodeProblem(build.problem);
    if (problemId(problem) == build.build) return problem;
  } catch (const Error&) {
    // The stored problem is damaged.
  }
  return std::nullopt;
}

void putTablesAside(const StateDirectory& directory) {
  const std::string file = directory.database().string();
  std::error_code error;
  std::filesystem::rename(file, file + ".damaged", error);
  for (const char* part : {"-wal", "-shm"})
    if (!error) std::filesystem::remove(file + part, error);
  if (error) throw failure("{0}: cannot rename to {0}.damaged: {1}", file, error.message());
}

StoredTables::StoredTables(const std::filesystem::path& directory, Database::Access access)
    : database_(existingDatabase(directory), access) {
  // This transaction is never committed, so all later reads see the present state, even if a
  // scheduler writes meanwhile.
  database_.execute("BEGIN");
  readBuild();
}

void StoredTables::readBuild() {
  checkVersion(database_);
  const auto build = ContentId::fromHex(meta(database_, "build"));
  if (!build) throw DamagedDatabase(database_.file(), "it has no build id");
  build_ = {*build, meta(database_, "scene_name"), meta(database_, "problem")};
}

void StoredTables::verify() { requireWhole(database_, "PRAGMA integrity_check(1)"); }

std::optional<Progress> StoredTables::progress() {
  Statement query(database_, "SELECT value FROM meta WHERE key = 'recorded'");
  if (!query.step()) return std::nullopt;
  return Progress{wholeNumber<std::size_t>(query, 0), meta(database_, "status")};
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
  while (query.step()) counters[query.text(0)] = wholeNumber<std::int64_t>(query, 1);
  return counters;
}

bool StoredTables::paused() { return meta(database_, "paused") == "1"; }

std::map<std::string, std::int32_t> StoredTables::priorities() {
  std::map<std::string, std::int32_t> found;
  Statement query(database_, "SELECT key, value FROM meta");
  while (query.step())
    if (const std::string key = query.text(0); key.starts_with(priority_of))
      found[key.substr(priority_of.size())] = query.integer<std::int32_t>(1);
  return found;
}

std::vector<KeptOut> StoredTables::keptOut() {
  using Kind = KeptOut::Kind;
  std::vector<KeptOut> found;
  Statement query(database_, "SELECT kind, worker, host, key, reason FROM kept_out ORDER BY rowid");
  while (query.step()) {
    KeptOut& one = found.emplace_back();
    for (const Kind kind : {Kind::process, Kind::machine, Kind::key})
      if (query.text(0) == name(kind)) one.kind = kind;
    one.who.set_worker(query.text(1));
    one.who.set_host(query.text(2));
    one.who.set_key(query.text(3));
    one.reason = query.text(4);
  }
  return found;
}

std::map<ResultKey, bool> StoredTables::checks() {
  std::map<ResultKey, bool> checks;
  Statement query(database_, "SELECT space, i, j, k, from_i, from_j, from_k, disputed FROM checks");
  const auto pointAt = [&](int column) {
    using Coordinate = LatticePoint::value_type;
    return LatticePoint{query.integer<Coordinate>(column), query.integer<Coordinate>(column + 1),
                        query.integer<Coordinate>(column + 2)};
  };
  while (query.step())
    checks[{query.integer<std::uint32_t>(0), pointAt(1), pointAt(4)}] = query.integer(7) != 0;
  return checks;
}

Tables::Tables(const StateDirectory& directory)
    : StoredTables(Database(directory.database(), Database::Access::read_write_create)) {
  readBuild();
}

Tables::Tables(const StateDirectory& directory, const Problem& problem, const ContentId& wanted)
    : StoredTables(openForWriting(directory, wanted)) {
  database_.execute("PRAGMA page_size = 8192; PRAGMA journal_mode = WAL");
  database_.execute(synchronous_as_a_rule);
  if (isEmpty(database_)) create(problem, wanted);
  readBuild();
  if (build_.build != wanted)
    throw badInput(
        "{}: holds build {} of scene \"{}\", "
        "but this is build {} of scene \"{}\" (scene or mesh changed): "
        "use another --state directory, or remove that one if its results are not needed",
        directory.path().string(), build_.build.shortHex(), build_.scene_name, wanted.shortHex(),
        problem.scene.name);
}

void Tables::create(const Problem& problem, const ContentId& build) {
  // Create everything in one transaction: a database without its meta would belong to no build.
  inTransaction(database_, [&] {
    database_.execute(schema);
    database_.execute(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}",
                                  application_id, schema_version));
    putMeta(database_, "build", build.hex());
    putMeta(database_, "scene_name", problem.scene.name);
    putMeta(database_, "problem", Blob{encodeProblem(problem)});
    putMeta(database_, "made_by", thisProgram());
    putMeta(database_, "secret", Blob{randomBytes(secret_bytes)});
  });
}

void Tables::writeProgress(const Progress& progress) {
  inTransaction(database_, [&] {
    putMeta(database_, "recorded", progress.recorded);
    putMeta(database_, "status", progress.status);
  });
}

void Tables::forgetProgress() {
  durably([&] { database_.execute("DELETE FROM meta WHERE key IN ('recorded', 'status')"); });
}

void Tables::writeServers(std::span<const wire::WorkerStatus> servers) {
  inTransaction(database_, [&] {
    Statement insert(database_,
                     "INSERT OR REPLACE INTO servers VALUES (?, ?, ?, ?, ?, "
                     "(julianday('now') - 2440587.5) * 86400.0 - ?, ?)");
    for (const wire::WorkerStatus& row : servers)
      insert.run(row.worker(), row.host(), row.pid(), row.kernel_family(), row.state(),
                 row.heard_seconds_ago(), row.results());
    // Delete all but the latest rows of workers that left without a result, because they could fill
    // the disk. A replaced row gets a new rowid, the highest.
    Statement(
        database_,
        "DELETE FROM servers WHERE results = 0 AND state IN ('lost', 'left') AND rowid NOT IN "
        "(SELECT rowid FROM servers WHERE results = 0 AND state IN ('lost', 'left') "
        "ORDER BY rowid DESC LIMIT ?)")
        .run(most_idle_departed);
  });
}

void Tables::writeCounters(const Counters& counters) {
  inTransaction(database_, [&] {
    Statement insert(database_, "INSERT OR REPLACE INTO counters VALUES (?, ?)");
    for (const auto& [name, value] : counters) insert.run(name, value);
  });
}

void Tables::writeLosses(const NumberedTransition& which, const Losses& losses) {
  const auto& [space, transition] = which;
  Statement(database_, "INSERT OR REPLACE INTO losses VALUES (?, ?, ?, ?, ?, ?)")
      .run(space, transition.target, transition.parent, losses.attempts, losses.suspected,
           losses.deaths);
}

std::map<Tables::NumberedTransition, Losses> Tables::losses() {
  std::map<NumberedTransition, Losses> losses;
  Statement query(database_,
                  "SELECT space, target, parent, attempts, suspected, deaths FROM losses");
  using Number = std::int32_t;
  while (query.step())
    losses[{query.integer<std::uint32_t>(0),
            {query.integer<Number>(1), query.integer<Number>(2)}}] = {
        wholeNumber<std::uint32_t>(query, 3), wholeNumber<int>(query, 4),
        wholeNumber<int>(query, 5)};
  return losses;
}

void Tables::keepOut(std::span<const KeptOut> liars) {
  durably([&] {
    Statement insert(database_, "INSERT INTO kept_out VALUES (?, ?, ?, ?, ?)");
    for (const auto& [kind, who, reason] : liars)
      insert.run(std::string(name(kind)), Blob{who.worker()}, who.host(), Blob{who.key()}, reason);
  });
}

void Tables::durably(const std::function<void()>& change) {
  database_.execute("PRAGMA synchronous = FULL");
  inTransaction(database_, change);
  database_.execute(synchronous_as_a_rule);
}

void Tables::writePaused(bool paused) {
  durably([&] { putMeta(database_, "paused", paused); });
}

void Tables::writePriority(const std::string& name, std::int32_t priority) {
  durably([&] { putMeta(database_, std::string(priority_of) + name, priority); });
}

void Tables::writeCheck(const ResultKey& key, bool disputed) {
  const auto write = [&] {
    const auto& [space, to, from] = key;
    Statement(database_, "INSERT OR REPLACE INTO checks VALUES (?, ?, ?, ?, ?, ?, ?, ?)")
        .run(space, to[0], to[1], to[2], from[0], from[1], from[2], disputed ? 1 : 0);
  };
  // Sync a dispute now: the worker that disagreed is acknowledged next, and the journal does not
  // record disputes.
  disputed ? durably(write) : write();
}

void Tables::forgetCheck(const ResultKey& key) {
  const auto& [space, to, from] = key;
  Statement(database_,
            "DELETE FROM checks WHERE space = ? AND i = ? AND j = ? AND k = ? "
            "AND from_i = ? AND from_j = ? AND from_k = ?")
      .run(space, to[0], to[1], to[2], from[0], from[1], from[2]);
}

std::string Tables::secret() {
  std::string secret = meta(database_, "secret");
  if (secret.size() == secret_bytes) return secret;
  // The secret was lost with damaged tables. Results that were leased under it are solved again.
  secret = randomBytes(secret_bytes);
  putMeta(database_, "secret", Blob{secret});
  return secret;
}

std::int64_t Tables::forgetLosses() {
  std::int64_t aside = 0;
  inTransaction(database_, [&] {
    Statement count(database_, "SELECT COUNT(*) FROM losses WHERE deaths >= ?");
    if (count.bind(deaths_before_aside).step()) aside = count.integer(0);
    count.reset();
    database_.execute("DELETE FROM losses");
  });
  return aside;
}

}  // namespace palpate
