#pragma once

#include <string>

#include "viewer/report/report.hpp"

namespace palpate {

/// The report for a terminal: at most 100 columns, ends with a newline.
std::string reportText(const Report& report);

}  // namespace palpate
