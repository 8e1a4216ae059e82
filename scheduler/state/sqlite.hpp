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

/// The file is no database, or its pages contradict each other.
class DamagedDatabase : public Error {
 public:
  DamagedDatabase(const std::filesystem::path& file, const std::string& what)
      : Error(ExitCode::failed, fmt::format("{}: damaged: {}", file.string(), what)) {}
};

/// An SQLite connection. Every return code is checked; failures are Errors that name the file.
/// Never carried across fork().
class Database {
 public:
  /// read_only: also where nobody may write. read_untouched: no file is made or changed; only of a
  /// database that nobody writes.
  enum class Access { read_write_create, read_only, read_untouched };
  Database(const std::filesystem::path& file, Access access);
  ~Database();
  Database(Database&& other) noexcept
      : file_(std::move(other.file_)), handle_(std::exchange(other.handle_, nullptr)) {}
  Database& operator=(Database&&) = delete;

  /// Runs one or more statements without results.
  void execute(const std::string& sql);
  /// Whatever it was opened for.
  bool isReadOnly() const;
  sqlite3* handle() const { return handle_; }
  const std::filesystem::path& file() const { return file_; }
  [[noreturn]] void fail(const std::string& doing) const;

 private:
  std::filesystem::path file_;
  sqlite3* handle_ = nullptr;
};

/// Bytes of a BLOB, where a string would be TEXT.
struct Blob {
  std::string_view bytes;
};

/// One prepared statement: bind or run it as often as wanted, reset() between. Values belong to the
/// ? of the SQL in order and are copied; columns are counted from 0. Must go before the Database.
class Statement {
 public:
  Statement(Database& database, const std::string& sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  /// Integers, doubles (NaN becomes NULL), strings and Blobs, as many as there are ?.
  template <class... Values>
  Statement& bind(const Values&... values) {
    expectValues(sizeof...(values));
    int index = 0;
    (put(++index, values), ...);
    return *this;
  }
  /// True when a row is there.
  bool step();
  /// bind, step and reset of a statement without rows.
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
  std::string text(int column) const;  ///< or the bytes of a BLOB

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

/// BEGIN IMMEDIATE, `work`, COMMIT: when it returns, all of it is recorded. Rolls back when one of
/// them throws.
void inTransaction(Database& database, const std::function<void()>& work);

}  // namespace palpate
