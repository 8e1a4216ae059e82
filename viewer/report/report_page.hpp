#pragma once

#include <string>

namespace palpate {

struct Comparison;
struct Report;
struct RunAccuracy;

/// Return an HTML page that needs no network. It contains the report's JSON, arrays for the
/// drawings, and a script that builds the tables, figures and sentences from them. The nodes in
/// Report::pictures are shown with pictures.
std::string pageOf(const Report& report);
std::string pageOf(const Comparison& comparison);
std::string pageOf(const RunAccuracy& run);

}  // namespace palpate
