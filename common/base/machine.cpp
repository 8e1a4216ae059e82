#include "common/base/machine.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <thread>

namespace palpate {
namespace {

template <class Value>
void lower(std::optional<Value>& limit, Value to) {
  limit = std::min(limit.value_or(to), to);
}

/// The number in a file; a group without a limit has -1.
std::optional<double> numberIn(std::istream&& file) {
  double number = 0;
  if (!(file >> number) || number <= 0) return std::nullopt;
  return number;
}

void addLimitsOf(const std::filesystem::path& group, GroupLimits& limits) {
  for (const char* name : {"memory.max", "memory.limit_in_bytes"}) {
    std::ifstream file(group / name);
    if (std::uint64_t bytes = 0; file >> bytes) lower(limits.memory_bytes, bytes);
  }
  // Microseconds of processor time, and in how many microseconds.
  std::ifstream together(group / "cpu.max");
  double quota = 0, period = 0;
  if (together >> quota >> period && quota > 0 && period > 0) lower(limits.cores, quota / period);
  const auto v1_quota = numberIn(std::ifstream(group / "cpu.cfs_quota_us"));
  const auto v1_period = numberIn(std::ifstream(group / "cpu.cfs_period_us"));
  if (v1_quota && v1_period) lower(limits.cores, *v1_quota / *v1_period);
}

}  // namespace

GroupLimits groupLimits(const std::filesystem::path& groups, const std::filesystem::path& mounted) {
  GroupLimits limits;
  std::ifstream lines(groups);
  // "4:cpu,cpuacct:/job/step", of version 2 "0::/job/step".
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    std::filesystem::path group = mounted / line.substr(first + 1, second - first - 1);
    addLimitsOf(group, limits);
    // In a container the path may be that of the machine, of which only the end is mounted.
    for (const auto& part : std::filesystem::path(line.substr(second + 1)).relative_path()) {
      if (part == "..") break;
      addLimitsOf(group /= part, limits);
    }
  }
  return limits;
}

unsigned coreCount() {
  unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  cpu_set_t allowed;
  // It fails on machines with more than 1024 cores, whose affinity is left aside.
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0)
    cores = std::min(cores, static_cast<unsigned>(CPU_COUNT(&allowed)));
  if (const auto quota = groupLimits().cores; quota && *quota < cores)
    cores = static_cast<unsigned>(std::ceil(*quota));
  return std::max(1U, cores);
}

std::optional<std::uint64_t> memoryBytes() {
  std::optional<std::uint64_t> bytes = groupLimits().memory_bytes;
  const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
  if (pages > 0 && page > 0)
    lower(bytes, static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page));
  return bytes;
}

}  // namespace palpate
