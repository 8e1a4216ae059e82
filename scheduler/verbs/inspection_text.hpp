#pragma once

#include "scheduler/state/inspection.hpp"

namespace palpate {

/// Formats an inspection as a page of text that ends with a line feed.
std::string describe(const Inspection& found, const std::filesystem::path& directory);
/// Formats an inspection as one JSON object (docs/commands.md). `repaired` is the result of
/// repair().
std::string inspectionJson(const Inspection& found, const std::filesystem::path& directory,
                           const std::vector<std::string>& repaired);

}  // namespace palpate
