#include "scheduler/state/sqlite.hpp"

#include <spdlog/spdlog.h>
#include <sqlite3.h>

#include <cmath>
#include <limits>

#include "common/base/error.hpp"

namespace palpate {

Database::Database(const std::filesystem::path& file, Access access) : file_(file) {
  const int flags = access == Access::read_only ? SQLITE_OPEN_READONLY
                                                : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  if (sqlite3_open_v2(file.c_str(), &handle_, flags, nullptr) != SQLITE_OK) {
    const std::string reason = handle_ == nullptr ? "out of memory" : sqlite3_errmsg(handle_);
    sqlite3_close(handle_);
    throw failure("{}: cannot open: {}", file.string(), reason);
  }
  if (sqlite3_busy_timeout(handle_, 5000) != SQLITE_OK) fail("busy timeout");
}

Database::~Database() {
  if (sqlite3_close(handle_) != SQLITE_OK)
    spdlog::warn("{}: statements were still open when it was closed", file_.string());
}

void Database::execute(const std::string& sql) {
  if (sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    fail(sql.substr(0, 60));
}

int Database::changes() const { return sqlite3_changes(handle_); }

void Database::fail(const std::string& doing) const {
  if (sqlite3_errcode(handle_) == SQLITE_FULL)
    throw failure(
        "{}: the disk is full: make room and start again; everything acknowledged is kept",
        file_.string());
  throw failure("{}: {} ({})", file_.string(), sqlite3_errmsg(handle_), doing);
}

Statement::Statement(Database& database, const std::string& sql) : database_(&database) {
  if (sqlite3_prepare_v2(database.handle(), sql.c_str(), static_cast<int>(sql.size()), &handle_,
                         nullptr) != SQLITE_OK)
    database.fail(sql.substr(0, 60));
}

Statement::~Statement() { sqlite3_finalize(handle_); }

Statement& Statement::bind(int index, std::int64_t value) {
  if (sqlite3_bind_int64(handle_, index, value) != SQLITE_OK) database_->fail("bind");
  return *this;
}

Statement& Statement::bind(int index, double value) {
  if (sqlite3_bind_double(handle_, index, value) != SQLITE_OK) database_->fail("bind");
  return *this;
}

Statement& Statement::bindText(int index, std::string_view value) {
  if (sqlite3_bind_text(handle_, index, value.data(), static_cast<int>(value.size()),
                        SQLITE_TRANSIENT) != SQLITE_OK)
    database_->fail("bind");
  return *this;
}

Statement& Statement::bindBlob(int index, std::string_view value) {
  if (sqlite3_bind_blob64(handle_, index, value.data(), value.size(), SQLITE_TRANSIENT) !=
      SQLITE_OK)
    database_->fail("bind");
  return *this;
}

Statement& Statement::bindNull(int index) {
  if (sqlite3_bind_null(handle_, index) != SQLITE_OK) database_->fail("bind");
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(handle_);
  if (code != SQLITE_ROW && code != SQLITE_DONE) database_->fail(sqlite3_sql(handle_));
  return code == SQLITE_ROW;
}

void Statement::run() {
  if (step())
    throw failure("{}: a row where none was expected ({})", database_->file().string(),
                  sqlite3_sql(handle_));
  reset();
}

void Statement::reset() {
  if (sqlite3_reset(handle_) != SQLITE_OK) database_->fail("reset");
}

bool Statement::isNull(int column) const {
  return sqlite3_column_type(handle_, column) == SQLITE_NULL;
}

std::int64_t Statement::integer(int column) const { return sqlite3_column_int64(handle_, column); }

double Statement::real(int column) const {
  return isNull(column) ? std::numeric_limits<double>::quiet_NaN()
                        : sqlite3_column_double(handle_, column);
}

std::string Statement::text(int column) const { return blob(column); }

std::string Statement::blob(int column) const {
  const void* bytes = sqlite3_column_blob(handle_, column);
  const int size = sqlite3_column_bytes(handle_, column);
  return bytes == nullptr
             ? std::string()
             : std::string(static_cast<const char*>(bytes), static_cast<std::size_t>(size));
}

Transaction::Transaction(Database& database) : database_(&database) {
  database.execute("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  // After some errors, a full disk among them, SQLite has rolled back by itself.
  if (!open_ || sqlite3_get_autocommit(database_->handle()) != 0) return;
  if (sqlite3_exec(database_->handle(), "ROLLBACK", nullptr, nullptr, nullptr) != SQLITE_OK)
    spdlog::warn("{}: rollback: {}", database_->file().string(),
                 sqlite3_errmsg(database_->handle()));
}

void Transaction::commit() {
  database_->execute("COMMIT");
  open_ = false;
}

}  // namespace palpate
