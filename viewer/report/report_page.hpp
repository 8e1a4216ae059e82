#pragma once

#include <string>

namespace palpate {

struct Comparison;
struct Report;

/// Return an HTML page that needs no network: the report's JSON with arrays for the drawings, and a
/// script that makes the tables, figures and sentences. Report::pictures are the nodes with
/// pictures.
std::string reportPage(const Report& report);
std::string comparisonPage(const Comparison& comparison);

}  // namespace palpate
