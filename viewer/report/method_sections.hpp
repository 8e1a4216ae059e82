#pragma once

#include <string>

#include "viewer/report/report.hpp"

// Sections of the page that compare methods.

namespace palpate {

/// The default method on the shown lattice, in six numbers.
std::string cards(const Report& report);

/// Error against configurations and against time: plots, and the numbers.
std::string frontierSection(const Report& report);

/// Work around closed loops.
std::string loopsSection(const Report& report);

/// How good the error bounds of the methods are.
std::string boundsSection(const Report& report);

/// The names of the methods with their lines and marks.
std::string methodLegend(const Report& report);

}  // namespace palpate
