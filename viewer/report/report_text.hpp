#pragma once

#include <string>

namespace palpate {

struct Comparison;
struct Report;
struct RunAccuracy;

/// Return the report as text for a terminal, with a final newline. Lines have at most 100 columns,
/// unless a file name is longer.
std::string textOf(const Report& report);
std::string textOf(const Comparison& comparison);
std::string textOf(const RunAccuracy& run);

}  // namespace palpate
