#pragma once

#include <string>
#include <vector>

#include "common/base/program.hpp"
#include "common/scene/scene.hpp"
#include "common/space/space_table.hpp"

namespace palpate {

/// For people, of a finished build: counts per tag of each space (the ones with most failures and
/// the sum, when there are many), failures by cause, and how far an adaptive scene's accuracy was
/// reached. Line feed at the end.
std::string summaryOf(const std::vector<SpaceTable>& spaces, const Scene& scene);

/// done, or partly_failed when a point failed that was tried. Unreachable ones lie beyond max_force
/// by design, or behind points that did fail. Probes do not count.
ExitCode exitCodeOf(const std::vector<SpaceTable>& spaces);

}  // namespace palpate
