#pragma once

#include <string>

#include "viewer/report/report.hpp"

namespace palpate {

/// The report as one HTML page with its plots inside: no script, nothing from the network. Samples
/// the fields of a few active nodes for the pictures (a second or two).
std::string reportPage(const Report& report);

}  // namespace palpate
