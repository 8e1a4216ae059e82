#include "scheduler/fleet/slurm.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <sstream>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/foreign_program.hpp"
#include "common/base/number_in.hpp"
#include "common/base/text.hpp"

namespace palpate {
namespace {

/// Number of ids per call of scancel, to limit its command line and the load of slurmctld.
constexpr std::size_t cancelled_at_once = 500;
/// Prefix of the endpoint in the comment of a job.
constexpr std::string_view comment_prefix = "palpate at ";

/// Returns the time between SIGTERM and the time limit, s. Slurm may send SIGTERM up to a minute
/// early, and short jobs need time to work too.
int secondsToLeave(int minutes) { return std::min(60, 15 * minutes); }

/// Returns true if sbatch will refuse again until an option is changed.
bool isLasting(const Ran& refusal) {
  constexpr int not_understood = 255;  // exit code: invalid command line
  const auto says = [&](const char* word) { return refusal.err.find(word) != std::string::npos; };
  const bool passes = says("nvalid authentication") || says("nvalid argument");
  return refusal.exit_code == not_understood || (says("nvalid") && !passes);
}

/// Runs a command and returns its output. Throws Error if the command refuses.
std::string orders(const std::vector<std::string>& words, const std::string& input = "") {
  Ran ran = runToItsEnd({.words = words, .package = "slurm-client", .input = input});
  if (ran.exit_code == 0) return std::move(ran.out);
  const std::string said = printable(ran.err.empty() ? ran.out : ran.err, longest_reason);
  throw Error(words[0] == "sbatch" && isLasting(ran) ? ExitCode::usage : ExitCode::failed,
              fmt::format("{} failed (exit code {}): {}", words[0], ran.exit_code, said));
}

// ---- Output of squeue ----

/// A column of squeue's output. squeue cuts off values that are longer than the width.
struct Column {
  const char* name;
  std::size_t width;
};
// Old versions of squeue know these columns too. The last column takes the rest of the line.
constexpr std::array columns = {Column{"State", 20},     Column{"JobArrayID", 40},
                                Column{"NodeList", 100}, Column{"exit_code", 12},
                                Column{"TimeUsed", 20},  Column{"EndTime", 24},
                                Column{"Comment", 200},  Column{"Reason", 200}};

std::string formatOfSqueue() {
  std::string text;
  for (const auto& [name, width] : columns)
    text += fmt::format("{}{}:{}", text.empty() ? "" : ",", name, width);
  return text;
}

std::array<std::string, columns.size()> cellsOf(std::string_view line) {
  std::array<std::string, columns.size()> cells;
  for (std::size_t n = 0; n < columns.size(); ++n) {
    std::string_view cell = line.substr(0, columns[n].width);
    line.remove_prefix(cell.size());
    cell = cell.substr(0, cell.find_last_not_of(' ') + 1);
    cells[n] = printable(cell, columns[n].width);
  }
  return cells;
}

/// Parses "[days-][[hours:]minutes:]seconds"; anything else counts as zero.
std::chrono::seconds elapsedOf(std::string_view text) {
  std::int64_t days = 0, seconds = 0;
  if (const auto dash = text.find('-'); dash != std::string_view::npos) {
    days = numberIn<std::uint16_t>(text.substr(0, dash)).value_or(0);
    text.remove_prefix(dash + 1);
  }
  while (!text.empty()) {
    const std::string_view number = text.substr(0, text.find(':'));
    seconds = 60 * seconds + numberIn<std::uint16_t>(number).value_or(0);
    text.remove_prefix(std::min(text.size(), number.size() + 1));
  }
  return std::chrono::seconds(24 * 3600 * days + seconds);
}

using States = std::set<std::string_view>;
const States queued_states = {"PENDING",     "REQUEUED",     "REQUEUE_HOLD",
                              "REQUEUE_FED", "SPECIAL_EXIT", "RESV_DEL_HOLD"};
const States running_states = {"RUNNING",  "CONFIGURING", "SUSPENDED", "STOPPED",
                               "RESIZING", "SIGNALING",   "STAGE_OUT"};
const States failed_states = {"FAILED", "BOOT_FAIL", "OUT_OF_MEMORY"};
const States well_states = {"COMPLETED", "TIMEOUT"};

/// Classifies the end of a job. `status` is an exit status in the form of wait().
Launches::Ended endOf(const std::string& state, std::string_view status,
                      const std::string& reason) {
  using How = Launches::Ended::How;
  Launches::Ended end;
  const int number = numberIn<int>(status).value_or(0);
  const bool told_to = WIFEXITED(number)
                           ? WEXITSTATUS(number) == static_cast<int>(ExitCode::interrupted)
                           : WTERMSIG(number) == SIGTERM;
  end.how = well_states.contains(state)                 ? How::well
            : failed_states.contains(state) && !told_to ? How::failed
                                                        : How::from_outside;
  end.words = reason == "NonZeroExitCode" ? "" : reason;
  const std::string how = WIFEXITED(number) ? fmt::format("exit code {}", WEXITSTATUS(number))
                                            : fmt::format("signal {}", WTERMSIG(number));
  if (number != 0) end.words += (end.words.empty() ? "" : ", ") + how;
  if (end.words.empty()) end.words = state;
  return end;
}

}  // namespace

std::map<std::string, int> SlurmJobs::reasons() const {
  std::map<std::string, int> count;
  for (const Queued& job : queued) ++count[job.reason];
  return count;
}

SlurmJobs SlurmJobs::parsed(const std::string& text, const std::string& endpoint) {
  SlurmJobs jobs;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const auto [state, id, node, status, used, when, comment, reason] = cellsOf(line);
    if (state.empty() || id.empty()) continue;
    const bool queued = queued_states.contains(state), running = running_states.contains(state);
    if ((queued || running) && comment.starts_with(comment_prefix) &&
        comment.substr(comment_prefix.size()) != endpoint) {
      jobs.elsewhere.push_back(id);
    } else if (queued) {
      jobs.queued.push_back({id, reason});
    } else if (running) {
      jobs.running.push_back({id, node, elapsedOf(used)});
    } else if (state != "COMPLETING") {
      Launches::Ended end = endOf(state, status, reason);
      end.id = id;
      end.node = node;
      end.age = elapsedOf(used);
      end.when = when;
      jobs.ended.push_back(std::move(end));
    }
  }
  std::ranges::stable_sort(jobs.ended, {}, &Launches::Ended::when);
  return jobs;
}

std::string Slurm::script(int workers, const std::set<std::string>& but_on) const {
  PALPATE_ASSERT(workers > 0, "a job script must start at least one worker");
  std::string text = "#!/bin/sh\n";
  const auto option = [&](const std::string& words) { text += "#SBATCH " + words + '\n'; };
  option("--job-name=" + options_.name);
  option(fmt::format("--array=1-{}", workers));
  option("--ntasks=1 --cpus-per-task=1");
  option(fmt::format("--time={}", options_.minutes));
  // B: sends the signal to the batch shell, which `exec` has replaced with the worker.
  option(fmt::format("--signal=B:TERM@{}", secondsToLeave(options_.minutes)));
  option("--requeue --open-mode=append");
  option("--output=" + options_.log);
  option(fmt::format("--comment=\"{}{}\"", comment_prefix, options_.endpoint));
  if (!options_.constraint.empty()) option("--constraint=" + options_.constraint);
  // sbatch uses only the last --exclude option, so merge them.
  std::vector<std::string> excluded(but_on.begin(), but_on.end());
  for (const std::string& words : options_.more) {
    constexpr std::string_view exclude = "--exclude=";
    if (words.starts_with(exclude) && !excluded.empty())
      excluded.push_back(words.substr(exclude.size()));
    option(words);
  }
  if (!excluded.empty()) option(fmt::format("--exclude={}", fmt::join(excluded, ",")));
  text += "exec";
  for (const std::string& word : options_.command) text += ' ' + shellQuoted(word);
  return text + '\n';
}

SlurmJobs Slurm::jobs() const {
  return SlurmJobs::parsed(orders({"squeue", "--me", "--noheader", "--array", "--states=all",
                                   "--name=" + options_.name, "--Format=" + formatOfSqueue()}),
                           options_.endpoint);
}

void Slurm::submit(int workers, const std::set<std::string>& but_on) {
  while (workers > 0) {
    const int some = std::min(workers, longest_array_);
    try {
      orders({"sbatch", "--parsable"}, script(some, but_on));
      workers -= some;
    } catch (const Error& error) {
      // MaxArraySize is configurable, so halve the arrays until sbatch accepts them.
      if (some == 1 ||
          std::string_view(error.what()).find("array specification") == std::string_view::npos)
        throw;
      longest_array_ = some / 2;
    }
  }
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

std::string Slurm::logOf(const std::string& id) const {
  const std::size_t bar = id.find('_');
  const std::string array = id.substr(0, bar);
  const std::string element = bar == std::string::npos ? "" : id.substr(bar + 1);
  return replacedAll(replacedAll(options_.log, "%A", array), "%a", element);
}

}  // namespace palpate
