#pragma once

#include <string>
#include <vector>

// Numbers as CSV (RFC 4180, but lines end with a line feed): a line of titles, then values;
// nothing where a value is not finite.

namespace palpate {

/// One line, with its end.
std::string csvLine(const std::vector<std::string>& cells);

/// In `figures` significant digits; empty when it is not finite.
std::string csvNumber(double value, int figures = 8);

}  // namespace palpate
