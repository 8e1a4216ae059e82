#pragma once

#include <filesystem>

#include "common/problem/problem.hpp"

namespace palpate {

/// Keeps what was computed for a scene that has changed since: the dataset `out` of another build
/// becomes OUT.<build>.h5, and an unfinished one in `state`, where that is the folder beside `out`,
/// OUT.<build>.h5.state, so that the old scene goes on with -o OUT.<build>.h5. Says so in one
/// sentence (log). Leaves what is no sound dataset, or no state that can be read; with `replace`
/// the dataset too, which is then written over.
///
/// Error when a scheduler works in `state`, or when a file cannot be renamed.
void setAsideWhatIsOfAnotherScene(const std::filesystem::path& out,
                                  const std::filesystem::path& state, const Problem& problem,
                                  bool replace);

}  // namespace palpate
