#pragma once

#include <string>

namespace palpate {

struct Comparison;
struct Report;

/// Return the report for a terminal: at most 100 columns except for file names, with a final
/// newline.
std::string reportText(const Report& report);
std::string comparisonText(const Comparison& comparison);

}  // namespace palpate
