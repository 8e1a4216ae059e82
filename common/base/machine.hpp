#pragma once

#include <filesystem>
#include <optional>

// The part of the machine that this process may use; containers, cluster jobs and taskset limit it.
// Any thread.

namespace palpate {

/// Returns the number of cores, at least 1.
unsigned coreCount();

/// Returns the cores that control groups (versions 1 and 2) allow this process: the least over its
/// groups and their parents, or nullopt without a limit. `groups` lists its groups like
/// /proc/self/cgroup; `mounted` is the mount point of the hierarchy.
std::optional<double> coresOfGroups(const std::filesystem::path& groups = "/proc/self/cgroup",
                                    const std::filesystem::path& mounted = "/sys/fs/cgroup");

}  // namespace palpate
