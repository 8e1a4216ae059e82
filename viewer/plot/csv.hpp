#pragma once

#include <string>
#include <vector>

// Numbers as CSV (RFC 4180, but lines end with a line feed): a line of titles, then values; empty
// for values that are not finite.

namespace palpate {

/// Returns one line, with its end.
std::string csvLine(const std::vector<std::string>& cells);

/// Returns `figures` significant digits; empty if the value is not finite.
std::string csvNumber(double value, int figures = 8);

}  // namespace palpate
