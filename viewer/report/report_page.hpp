#pragma once

#include <string>

#include "viewer/report/report.hpp"

namespace palpate {

/// The report as one HTML page with its plots inside: no script, nothing from the network. Pictures
/// are of Report::pictures.
std::string reportPage(const Report& report);

}  // namespace palpate
