#pragma once

#include <string>

#include "viewer/report/report.hpp"

namespace palpate {

/// The report as one JSON object on one line (docs/commands.md). Numbers that do not exist are
/// null.
std::string reportJson(const Report& report);

}  // namespace palpate
