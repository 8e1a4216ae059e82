#pragma once

#include <string>

#include "viewer/report/report.hpp"

// Sections of the page about the datasets themselves.

namespace palpate {

/// Failures of the first dataset, by cause.
std::string failuresSection(const Report& report);

/// What takes the room in the files.
std::string sizesSection(const Report& report);

/// What was computed, and by what: ids, workspace, the whole scene.
std::string provenanceSection(const Report& report);

}  // namespace palpate
