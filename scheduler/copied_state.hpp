#pragma once

#include <filesystem>
#include <optional>

#include "common/keys/key_folder.hpp"

namespace palpate {

class ContentId;

/// Error when `state` is a copy of the directory of a scheduler that still works for this build,
/// where the copied files say: each of the two would have all of it computed. Asks there, with the
/// keys that the files name or else with these, only when nobody works in `state` itself; what
/// cannot be found out is told (log) and no reason. That one is not found when it listens on all
/// addresses of another machine, or is not reached from here.
void refuseCopyOfLiving(const std::filesystem::path& state, const ContentId& build,
                        const std::optional<KeyFolder>& keys);

}  // namespace palpate
