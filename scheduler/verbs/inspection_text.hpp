#pragma once

#include "scheduler/state/inspection.hpp"

namespace palpate {

/// What was found in a state directory as a page of text for people, with a line feed at the end.
std::string describe(const Inspection& found, const std::filesystem::path& directory);
/// The same as one JSON object (docs/commands.md). `repaired`: what repair() did.
std::string inspectionJson(const Inspection& found, const std::filesystem::path& directory,
                           const std::vector<std::string>& repaired);

}  // namespace palpate
