#pragma once

#include <string>

namespace palpate {

struct Comparison;
struct Report;

/// One HTML page that needs nothing from the network: the JSON of the report, with arrays for the
/// drawings, and a script that makes tables, figures and sentences of it. Pictures are of
/// Report::pictures.
std::string reportPage(const Report& report);
std::string comparisonPage(const Comparison& comparison);

}  // namespace palpate
