#pragma once

#include <filesystem>
#include <optional>

// The cores that this process may use. Containers, cluster jobs and taskset can limit it to a part
// of the machine. Any thread.

namespace palpate {

/// Returns the number of cores, at least 1.
unsigned coreCount();

/// Returns the number of cores, which may be a fraction, to which control groups (versions 1 and 2)
/// limit this process. This is the smallest limit of its groups and their parents, or nullopt if
/// none of them has a limit. `groups` is a file like /proc/self/cgroup that lists the groups of the
/// process; `mounted` is the folder at which the group hierarchy is mounted.
std::optional<double> coresOfGroups(const std::filesystem::path& groups = "/proc/self/cgroup",
                                    const std::filesystem::path& mounted = "/sys/fs/cgroup");

}  // namespace palpate
