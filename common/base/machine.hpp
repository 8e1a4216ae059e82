#pragma once

#include <filesystem>
#include <optional>

// What this process may use of its machine: containers, jobs of a cluster and taskset leave it a
// part. Any thread.

namespace palpate {

/// Cores, at least 1.
unsigned coreCount();

/// Cores that control groups allow a process, the least of its groups and of those around them, of
/// version 2 and 1; nothing where they set no limit. `groups` lists its groups as /proc/self/cgroup
/// does, `mounted` is where they are.
std::optional<double> coresOfGroups(const std::filesystem::path& groups = "/proc/self/cgroup",
                                    const std::filesystem::path& mounted = "/sys/fs/cgroup");

}  // namespace palpate
