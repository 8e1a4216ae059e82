#include "common/base/machine.hpp"

#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <thread>
#include <utility>

#include "common/base/error.hpp"

namespace palpate {
namespace {

/// Reads a positive number from a file; nullopt for anything else. In a group without a limit the
/// number is -1.
std::optional<double> numberIn(std::istream&& file) {
  double number = 0;
  if (!(file >> number) || number <= 0) return std::nullopt;
  return number;
}

/// Lowers `cores` to the limit of a control group, if it has one.
void lowerToLimitOf(const std::filesystem::path& group, std::optional<double>& cores) {
  const auto lower = [&](double to) { cores = std::min(cores.value_or(to), to); };
  // In version 2 of control groups, cpu.max holds the allowed processor time per period, then the
  // period, both in microseconds.
  std::ifstream together(group / "cpu.max");
  double quota = 0, period = 0;
  if (together >> quota >> period && quota > 0 && period > 0) lower(quota / period);
  const auto v1_quota = numberIn(std::ifstream(group / "cpu.cfs_quota_us"));
  const auto v1_period = numberIn(std::ifstream(group / "cpu.cfs_period_us"));
  if (v1_quota && v1_period) lower(*v1_quota / *v1_period);
}

/// Returns the limit that denies this process memory, with the remedy.
std::string whyNotGranted() {
  for (const auto& [resource, option] :
       {std::pair{RLIMIT_AS, "-v"}, std::pair{RLIMIT_DATA, "-d"}}) {
    struct rlimit limit {};
    if (getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
      return fmt::format("the limit is {} MiB (ulimit {}): raise it to 1000 MiB or more",
                         limit.rlim_cur >> 20, option);
  }
  return "free memory, or let the system overcommit (sysctl vm.overcommit_memory=0)";
}

}  // namespace

std::optional<double> coresOfGroups(const std::filesystem::path& groups,
                                    const std::filesystem::path& mounted) {
  std::optional<double> cores;
  std::ifstream lines(groups);
  // A line is like "4:cpu,cpuacct:/job/step" in version 1, and "0::/job/step" in version 2.
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    std::filesystem::path group = mounted / line.substr(first + 1, second - first - 1);
    lowerToLimitOf(group, cores);
    // Check the group and its parents. In a container the path may be the one on the host, although
    // only the container's own group is mounted here. Folders that do not exist set no limit.
    for (const auto& part : std::filesystem::path(line.substr(second + 1)).relative_path()) {
      if (part == "..") break;
      lowerToLimitOf(group /= part, cores);
    }
  }
  return cores;
}

unsigned coreCount() {
  unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  cpu_set_t allowed;
  // This fails on machines with more than 1024 cores. Their affinity mask is ignored.
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0)
    cores = std::min(cores, static_cast<unsigned>(CPU_COUNT(&allowed)));
  if (const auto quota = coresOfGroups(); quota && *quota < cores)
    cores = static_cast<unsigned>(std::ceil(*quota));
  return std::max(1U, cores);
}

void giveWay() {
  constexpr int lowest = 19;  // a nice value, which Linux keeps for each thread
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), lowest);
}

void requireMemory(std::size_t bytes) {
  void* const room =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (room == MAP_FAILED)
    throw failure("solving needs {} MiB more, which the system does not grant: {}", bytes >> 20,
                  whyNotGranted());
  munmap(room, bytes);
}

}  // namespace palpate
