#pragma once

#include <string>
#include <vector>

// Numbers as CSV (RFC 4180, but lines end with a line feed). The first line holds the titles, the
// others hold values. The cell of a value that is not finite is empty.

namespace palpate {

/// Returns one line, including its line feed.
std::string csvLine(const std::vector<std::string>& cells);

}  // namespace palpate
