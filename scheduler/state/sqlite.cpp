#include "scheduler/state/sqlite.hpp"

#include <spdlog/spdlog.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cerrno>

#include "common/base/assertion.hpp"

namespace palpate {

namespace {

/// Returns a URI that keeps SQLite from changing files. Otherwise, to read a database that was left
/// in WAL mode, SQLite creates an index of its log beside the database or writes into the existing
/// one.
std::string untouched(const std::filesystem::path& file) {
  std::string uri = "file://";
  for (const char c : std::filesystem::absolute(file).string())
    uri += std::string_view("%?#").find(c) == std::string_view::npos
               ? std::string(1, c)
               : fmt::format("%{:02x}", static_cast<int>(c));
  // Without a log the file is complete: the last connection copied and removed the log.
  std::error_code none;
  const auto log_size = std::filesystem::file_size(file.string() + "-wal", none);
  if (none || log_size == 0) return uri + "?immutable=1";
  const std::string index = file.string() + "-shm";
  if (!std::filesystem::exists(index))
    throw failure(
        "{}: its log was copied without {}, so SQLite would ignore the log: create an empty file "
        "of that name",
        file.string(), index);
  return uri + "?readonly_shm=1";
}

bool mayWriteIn(const std::filesystem::path& folder) { return access(folder.c_str(), W_OK) == 0; }

}  // namespace

Database::Database(const std::filesystem::path& file, Access access) : file_(file) {
  const bool writes = access == Access::read_write_create;
  const bool touches = writes || (access == Access::read_only && mayWriteIn(file.parent_path()));
  const int flags = writes ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE
                           : SQLITE_OPEN_READONLY | (touches ? 0 : SQLITE_OPEN_URI);
  const std::string opened = touches ? file.string() : untouched(file);
  if (sqlite3_open_v2(opened.c_str(), &handle_, flags, nullptr) != SQLITE_OK) {
    const std::string reason = handle_ == nullptr ? "out of memory" : sqlite3_errmsg(handle_);
    sqlite3_close(handle_);
    throw failure("{}: cannot open: {}", file.string(), reason);
  }
  // Other processes hold the lock only for moments: to open the database or checkpoint the log.
  if (sqlite3_busy_timeout(handle_, 5000) != SQLITE_OK) fail("busy timeout");
}

Database::~Database() {
  // The handle of a moved-from object is null, which SQLite accepts.
  if (sqlite3_close(handle_) != SQLITE_OK)
    spdlog::warn("{}: closed while statements were open", file_.string());
}

void Database::execute(const std::string& sql) {
  if (sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    fail(sql.substr(0, 60));
}

bool Database::isReadOnly() const { return sqlite3_db_readonly(handle_, "main") == 1; }

void Database::fail(const std::string& doing) const {
  // If there is no room for the index of its log, SQLite reports an input/output error.
  if (sqlite3_errcode(handle_) == SQLITE_FULL || sqlite3_system_errno(handle_) == ENOSPC)
    throw failure(
        "{}: the disk is full: make room and start again; all acknowledged results are kept",
        file_.string());
  if (const int code = sqlite3_errcode(handle_); code == SQLITE_CORRUPT || code == SQLITE_NOTADB)
    throw DamagedDatabase(file_, sqlite3_errmsg(handle_));
  const bool of_the_disk = (sqlite3_errcode(handle_) & 0xff) == SQLITE_IOERR;
  throw failure("{}: {} ({}){}", file_.string(), sqlite3_errmsg(handle_), doing,
                of_the_disk ? ": check the disk and the file size limit (ulimit -f)" : "");
}

Statement::Statement(Database& database, const std::string& sql) : database_(&database) {
  if (sqlite3_prepare_v2(database.handle(), sql.c_str(), static_cast<int>(sql.size()), &handle_,
                         nullptr) != SQLITE_OK)
    database.fail(sql.substr(0, 60));
}

void Statement::expectValues(int count) const {
  PALPATE_ASSERT(count == sqlite3_bind_parameter_count(handle_), "each SQL ? must get a value");
}

Statement::~Statement() { sqlite3_finalize(handle_); }

void Statement::putInteger(int index, std::int64_t value) {
  check(sqlite3_bind_int64(handle_, index, value), "bind");
}

void Statement::put(int index, double value) {
  check(sqlite3_bind_double(handle_, index, value), "bind");
}

void Statement::put(int index, std::string_view text) {
  // SQLITE_TRANSIENT makes SQLite copy the text, because the caller's string may be destroyed
  // before step().
  check(sqlite3_bind_text(handle_, index, text.data(), static_cast<int>(text.size()),
                          SQLITE_TRANSIENT),
        "bind");
}

void Statement::put(int index, Blob blob) {
  check(sqlite3_bind_blob64(handle_, index, blob.bytes.data(), blob.bytes.size(), SQLITE_TRANSIENT),
        "bind");
}

void Statement::check(int code, const char* doing) const {
  if (code != SQLITE_OK) database_->fail(doing);
}

bool Statement::step() {
  const int code = sqlite3_step(handle_);
  if (code != SQLITE_ROW && code != SQLITE_DONE) database_->fail(sqlite3_sql(handle_));
  return code == SQLITE_ROW;
}

void Statement::finish() {
  const bool row = step();
  PALPATE_ASSERT(!row, "an SQL command must not return rows");
  reset();
}

void Statement::reset() { check(sqlite3_reset(handle_), "reset"); }

std::int64_t Statement::integerIn(int column) const {
  PALPATE_ASSERT(column < sqlite3_data_count(handle_), "a row with this column must be there");
  return sqlite3_column_int64(handle_, column);
}

double Statement::real(int column) const { return sqlite3_column_double(handle_, column); }

std::string Statement::text(int column) const {
  // Ask for the bytes before the length: the opposite order could convert the value and move it.
  const void* bytes = sqlite3_column_blob(handle_, column);
  const int size = sqlite3_column_bytes(handle_, column);
  return bytes == nullptr
             ? std::string()
             : std::string(static_cast<const char*>(bytes), static_cast<std::size_t>(size));
}

void inTransaction(Database& database, const std::function<void()>& work) {
  database.execute("BEGIN IMMEDIATE");
  try {
    work();
    database.execute("COMMIT");
  } catch (...) {
    // After some errors, such as a full disk, SQLite has already rolled back.
    if (sqlite3_get_autocommit(database.handle()) == 0 &&
        sqlite3_exec(database.handle(), "ROLLBACK", nullptr, nullptr, nullptr) != SQLITE_OK)
      spdlog::warn("{}: rollback: {}", database.file().string(), sqlite3_errmsg(database.handle()));
    throw;
  }
}

}  // namespace palpate
