#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

// The cores and the memory that this process may use. Containers, cluster jobs, taskset and ulimit
// can limit it to a part of the machine. Any thread.

namespace palpate {

/// Returns the number of cores, at least 1.
unsigned coreCount();

/// Gives the calling thread, and threads and programs that it starts later, the lowest priority.
void giveWay();

/// Returns the number of cores, which may be a fraction, to which control groups (versions 1 and 2)
/// limit this process. This is the smallest limit of its groups and their parents, or nullopt if
/// none of them has a limit. `groups` is a file like /proc/self/cgroup that lists the groups of the
/// process; `mounted` is the folder at which the group hierarchy is mounted.
std::optional<double> coresOfGroups(const std::filesystem::path& groups = "/proc/self/cgroup",
                                    const std::filesystem::path& mounted = "/sys/fs/cgroup");

/// Memory that a solver program needs at its start, bytes. The process that starts it should call
/// requireMemory() with this size, because OpenBLAS 0.3.29 and later waits forever if the system
/// refuses its memory. It requests the memory while it is loaded, before main() runs.
inline constexpr std::size_t memory_of_a_solver = 384u << 20;
/// Tests whether the system grants this process that many bytes now, and frees them. Error, with
/// the limit and the remedy, if it does not.
void requireMemory(std::size_t bytes);

}  // namespace palpate
