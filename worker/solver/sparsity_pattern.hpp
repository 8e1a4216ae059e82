#pragma once

#include <cstdint>
#include <vector>

namespace palpate {

/// Where the upper triangle of a symmetric matrix has entries, row by row and in each row by
/// column. 1-based as MUMPS wants it; every diagonal entry is there.
struct SparsityPattern {
  std::int32_t n = 0;                     ///< rows
  std::vector<std::int32_t> row, column;  ///< of every entry, 1 to n, row <= column
  /// n + 1 numbers, 0-based: row k of them has the entries row_begin[k] to row_begin[k + 1], and
  /// the first of these is its diagonal.
  std::vector<std::int32_t> row_begin;

  /// The entry in row min(a, b) and column max(a, b), 0-based; it must be there.
  std::int32_t entryOf(std::int32_t a, std::int32_t b) const;
};

/// The pattern in which row k, 0-based, has these columns, also 0-based, at least k itself. They
/// may repeat and stand in any order, none of them left of the diagonal.
SparsityPattern patternOf(std::vector<std::vector<std::int32_t>> columns_of_rows);

}  // namespace palpate
