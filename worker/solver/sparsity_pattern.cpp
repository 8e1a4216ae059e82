#include "worker/solver/sparsity_pattern.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"

namespace palpate {

std::int32_t SparsityPattern::entryOf(std::int32_t a, std::int32_t b) const {
  const std::int32_t upper = std::min(a, b), wanted = std::max(a, b) + 1;
  const auto begin = column.begin() + row_begin[upper], end = column.begin() + row_begin[upper + 1];
  const auto found = std::lower_bound(begin, end, wanted);
  PALPATE_ASSERT(found != end && *found == wanted,
                 "elements share entries only where the pattern was made from them");
  return static_cast<std::int32_t>(found - column.begin());
}

SparsityPattern patternOf(std::vector<std::vector<std::int32_t>> columns_of_rows) {
  SparsityPattern pattern;
  pattern.n = static_cast<std::int32_t>(columns_of_rows.size());
  for (std::int32_t row = 0; row < pattern.n; ++row) {
    std::vector<std::int32_t>& columns = columns_of_rows[row];
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    PALPATE_ASSERT(!columns.empty() && columns.front() == row,
                   "an unknown without a diagonal occurs in no element: its row would be singular");
    pattern.row_begin.push_back(static_cast<std::int32_t>(pattern.row.size()));
    for (const std::int32_t column : columns) {
      pattern.row.push_back(row + 1);
      pattern.column.push_back(column + 1);
    }
  }
  pattern.row_begin.push_back(static_cast<std::int32_t>(pattern.row.size()));
  return pattern;
}

}  // namespace palpate
