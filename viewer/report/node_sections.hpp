#pragma once

#include <string>

#include "viewer/report/report.hpp"

// Sections of the page about single active nodes, the worst first.

namespace palpate {

/// Points, errors and curves of each.
std::string nodesSection(const Report& report);

/// Error bounds and errors in three planes, of Report::pictures.
std::string mapsSection(const Report& report);

/// Forces along the axes, of Report::pictures.
std::string curvesSection(const Report& report);

}  // namespace palpate
