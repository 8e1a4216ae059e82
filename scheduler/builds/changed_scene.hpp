#pragma once

#include <filesystem>

#include "common/problem/problem.hpp"

namespace palpate {

/// Preserves earlier results when the scene has changed. If the dataset `out` belongs to another
/// build, renames it to OUT.<build>.h5. If `state` is the default directory beside `out` and holds
/// the state of another build, renames it to OUT.<build>.h5.state, so that the old scene can be
/// resumed with -o OUT.<build>.h5. Logs what was renamed. Leaves unreadable datasets and states
/// untouched; with `replace`, also leaves the dataset, which is overwritten later.
///
/// Throws Error if a scheduler runs in `state` or a file cannot be renamed.
void setAsideWhatIsOfAnotherScene(const std::filesystem::path& out,
                                  const std::filesystem::path& state, const Problem& problem,
                                  bool replace);

}  // namespace palpate
