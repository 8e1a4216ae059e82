#include "scheduler/fleet/slurm.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <sstream>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/printable.hpp"
#include "scheduler/fleet/engine_command.hpp"

namespace palpate {
namespace {

/// Slurm's MaxArraySize is 1001 unless somebody raised it.
constexpr int longest_array = 1000;
/// A command line has an end, and so has the patience of slurmctld.
constexpr std::size_t cancelled_at_once = 500;

/// Slurm may come a minute early, and short jobs are to work too.
int secondsToLeave(int minutes) { return std::min(60, 15 * minutes); }

std::string orders(const std::vector<std::string>& words, const std::string& input = "") {
  Ran ran = runOfEngine(words, input);
  if (ran.exit_code != 0)
    throw failure("{} says no (exit code {}): {}", words[0], ran.exit_code,
                  printable(ran.err.empty() ? ran.out : ran.err, 500));
  return std::move(ran.out);
}

/// As a shell reads it back.
std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

bool isQueued(const std::string& state) {
  constexpr std::array waiting = {"PENDING",     "REQUEUED",     "REQUEUE_HOLD",
                                  "REQUEUE_FED", "SPECIAL_EXIT", "RESV_DEL_HOLD"};
  return std::ranges::find(waiting, state) != waiting.end();
}

}  // namespace

std::string Slurm::script(int workers) const {
  PALPATE_ASSERT(workers > 0 && workers <= longest_array, "longer arrays are cut before");
  std::string text = "#!/bin/sh\n";
  const auto option = [&](const std::string& words) { text += "#SBATCH " + words + '\n'; };
  option("--job-name=" + options_.name);
  option(fmt::format("--array=1-{}", workers));
  option("--ntasks=1 --cpus-per-task=1");
  option(fmt::format("--time={}", options_.minutes));
  // B: the shell, whose place the worker takes.
  option(fmt::format("--signal=B:TERM@{}", secondsToLeave(options_.minutes)));
  option("--requeue --open-mode=append");
  option("--output=" + options_.log);
  if (!options_.constraint.empty()) option("--constraint=" + options_.constraint);
  for (const std::string& words : options_.more) option(words);
  text += "exec";
  for (const std::string& word : options_.command) text += ' ' + quoted(word);
  return text + '\n';
}

Slurm::Jobs Slurm::jobs() const {
  std::istringstream lines(orders(
      {"squeue", "--me", "--noheader", "--array", "--name=" + options_.name, "--format=%T %i %r"}));
  Jobs jobs;
  for (std::string state, id, reason; lines >> state >> id && std::getline(lines, reason);) {
    if (!isQueued(state)) {
      ++jobs.running;
      continue;
    }
    jobs.queued.push_back(id);
    reason.erase(0, reason.find_first_not_of(' '));
    ++jobs.why_queued[printable(reason)];
  }
  return jobs;
}

void Slurm::submit(int workers) const {
  for (int left = workers; left > 0; left -= longest_array)
    orders({"sbatch", "--parsable"}, script(std::min(left, longest_array)));
}

void Slurm::cancel(const std::vector<std::string>& ids) const {
  for (std::size_t at = 0; at < ids.size(); at += cancelled_at_once) {
    std::vector<std::string> words = {"scancel"};
    const auto begin = ids.begin() + static_cast<std::ptrdiff_t>(at);
    const auto count = std::min(cancelled_at_once, ids.size() - at);
    words.insert(words.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
    orders(words);
  }
}

void Slurm::cancelAll() const { orders({"scancel", "--me", "--name=" + options_.name}); }

}  // namespace palpate
