#pragma once

#include <string>

namespace palpate {

struct Comparison;
struct Report;

/// For a terminal: at most 100 columns but for names of files, ends with a newline.
std::string reportText(const Report& report);
std::string comparisonText(const Comparison& comparison);

}  // namespace palpate
