#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "common/base/error.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace palpate {

/// Thrown if the file is not a database, or if its pages are inconsistent.
class DamagedDatabase : public Error {
 public:
  DamagedDatabase(const std::filesystem::path& file, const std::string& what)
      : Error(ExitCode::failed, fmt::format("{}: damaged: {}", file.string(), what)) {}
};

/// An SQLite connection. Every return code is checked; errors name the file. Must not be used
/// across fork().
class Database {
 public:
  /// read_only also works in a folder without write permission. read_untouched neither creates nor
  /// changes a file; use it only if no process writes the database.
  enum class Access { read_write_create, read_only, read_untouched };
  Database(const std::filesystem::path& file, Access access);
  ~Database();
  Database(Database&& other) noexcept
      : file_(std::move(other.file_)), handle_(std::exchange(other.handle_, nullptr)) {}

  /// Runs one or more statements without results.
  void execute(const std::string& sql);
  /// True if SQLite regards the database as read-only, whatever access was asked for.
  bool isReadOnly() const;
  sqlite3* handle() const { return handle_; }
  const std::filesystem::path& file() const { return file_; }
  [[noreturn]] void fail(const std::string& doing) const;

 private:
  std::filesystem::path file_;
  sqlite3* handle_ = nullptr;
};

/// Bytes that are bound as a BLOB. Strings are bound as TEXT.
struct Blob {
  std::string_view bytes;
};

/// One prepared statement. It can be bound and run any number of times, with reset() in between.
/// Values are bound to the question marks of the SQL text, in order, and are copied. Columns are
/// numbered from 0. Must be destroyed before the Database.
class Statement {
 public:
  Statement(Database& database, const std::string& sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  /// Binds integers, doubles (NaN becomes NULL), strings and Blobs, one value per question mark.
  template <class... Values>
  Statement& bind(const Values&... values) {
    expectValues(sizeof...(values));
    int index = 0;
    (put(++index, values), ...);
    return *this;
  }
  /// Runs to the next row. Returns false if there is none.
  bool step();
  /// Binds, runs and resets a statement that returns no rows.
  template <class... Values>
  void run(const Values&... values) {
    bind(values...).finish();
  }
  void reset();

  template <std::integral Integer = std::int64_t>
  Integer integer(int column) const {
    return static_cast<Integer>(integerIn(column));
  }
  double real(int column) const;
  std::string text(int column) const;  ///< TEXT, or the bytes of a BLOB

 private:
  template <std::integral Integer>
  void put(int index, Integer value) {
    putInteger(index, static_cast<std::int64_t>(value));
  }
  void put(int index, double value);
  void put(int index, std::string_view text);
  void put(int index, Blob blob);
  void expectValues(int count) const;
  void putInteger(int index, std::int64_t value);
  std::int64_t integerIn(int column) const;
  void check(int code, const char* doing) const;
  void finish();

  Database* database_;
  sqlite3_stmt* handle_ = nullptr;
};

/// Runs `work` between BEGIN IMMEDIATE and COMMIT. Rolls back if `work` or the commit throws.
void inTransaction(Database& database, const std::function<void()>& work);

}  // namespace palpate
