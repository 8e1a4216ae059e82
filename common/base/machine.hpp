#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

// What this process may use of its machine: containers, jobs of a cluster and taskset leave it a
// part. Any thread.

namespace palpate {

/// Cores, at least 1.
unsigned coreCount();

/// Bytes of memory; nothing when the system does not say.
std::optional<std::uint64_t> memoryBytes();

/// What control groups allow a process; nothing where they set no limit.
struct GroupLimits {
  std::optional<std::uint64_t> memory_bytes;
  std::optional<double> cores;
};
/// The least of its groups and of those around them, of version 2 and 1. `groups` lists its groups
/// as /proc/self/cgroup does, `mounted` is where they are.
GroupLimits groupLimits(const std::filesystem::path& groups = "/proc/self/cgroup",
                        const std::filesystem::path& mounted = "/sys/fs/cgroup");

}  // namespace palpate
