#include "scheduler/fleet/slurm_fleet.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <thread>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "common/base/text.hpp"

namespace palpate {
namespace {

using std::chrono::seconds;

/// If a job is older than this and no worker is connected, it probably cannot reach the scheduler.
constexpr seconds long_unheard{60};

/// Returns the number of jobs that are queued or have just started.
int unproven(const SlurmJobs& jobs) {
  return static_cast<int>(jobs.queued.size()) +
         static_cast<int>(std::ranges::count_if(
             jobs.running, [](const Launches::Running& job) { return job.age < Launches::early; }));
}

std::string reasonsOf(const SlurmJobs& jobs) {
  std::string text;
  for (const auto& [reason, count] : jobs.reasons())
    text += fmt::format("{}{} {}", text.empty() ? " (" : ", ", count, reason);
  return text.empty() ? "" : text + ")";
}

/// Returns the last line of a file, made printable; empty if it cannot be read here.
std::string lastLineOf(const std::string& path) {
  constexpr std::streamoff most = 4096;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return "";
  file.seekg(std::max<std::streamoff>(0, file.tellg() - most));
  std::string last;
  for (std::string line; std::getline(file, line);)
    if (!line.empty()) last = line;
  return printable(last, longest_reason);
}

/// Says where the log is, and quotes its last line.
std::string wroteOf(const std::string& log) {
  if (log == "/dev/null") return "use --log FILE to keep their output";
  const std::string line = lastLineOf(log);
  return line.empty() ? "see " + log : fmt::format("{} ends with: {}", log, line);
}

std::string nameOf(const Launches::Ended& end) {
  return fmt::format("{}{}{} ({})", end.id, end.node.empty() ? "" : " on ", end.node, end.words);
}

}  // namespace

SlurmFleet::SlurmFleet(const SlurmFleetOptions& options)
    : options_(options),
      engine_(options.slurm),
      watch_(options),
      launches_(seconds(2 * options.every_s)),
      refused_(seconds(2 * options.every_s)) {}

ExitCode SlurmFleet::run() {
  for (;;) {
    const auto status = watch_.look();
    if (interrupted()) return leave();
    if (status && status->state() == "complete") return finish("the build is complete");
    if (!status && watch_.gaveUp()) {
      finish("the scheduler no longer answers");
      return ExitCode::failed;
    }
    turn(status);
    if (options_.dry_run) return ExitCode::done;
    for (const auto until = Clock::now() + seconds(options_.every_s); Clock::now() < until;) {
      if (interrupted()) return leave();
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }
}

void SlurmFleet::turn(const std::optional<wire::Status>& status) try {
  const SlurmJobs jobs = engine_.jobs();
  taken_ = taken_ || !jobs.queued.empty() || !jobs.running.empty();
  const Launches::Change change = launches_.see(jobs.ended, jobs.running, Clock::now());
  tellLaunches(change);
  // After cancelling, do no more in this turn: the next turn sees which jobs remain.
  if (!options_.dry_run && cancelUnwanted(jobs, !change.left_out.empty())) return;
  // Keep running and queued jobs, because the scheduler may soon be back.
  if (!status) return tell(jobs, 0, "the scheduler does not answer");
  const int more = moreFor(jobs, *status);
  tell(jobs, more, fmt::format("{} solves are ready to start", status->ready()));
  if (options_.dry_run) return;
  if (more > 0 && refused_.over(Clock::now())) submit(more);
  if (more < 0) {
    const auto ids = mapped(jobs.queued, &SlurmJobs::Queued::id);
    PALPATE_ASSERT(static_cast<std::size_t>(-more) <= ids.size(), "only queued jobs may be ended");
    engine_.cancel({ids.end() + more, ids.end()});
  }
} catch (const Error& error) {
  if (endsIt(error)) throw;
  spdlog::warn("{}", error.what());
}

/// Returns true if the error is permanent and Slurm has no job of the build that would be left
/// behind.
bool SlurmFleet::endsIt(const Error& error) const {
  return error.exitCode() == ExitCode::usage && !taken_;
}

/// Submits jobs. Waits longer after each further refusal.
void SlurmFleet::submit(int more) try {
  engine_.submit(more, launches_.badNodes());
  taken_ = true;
  refused_.succeeded();
} catch (const Error& error) {
  if (endsIt(error)) throw;
  refused_.failed(Clock::now());
  spdlog::warn("{}; trying again in {} s", error.what(), refused_.pause().count());
}

int SlurmFleet::moreFor(const SlurmJobs& jobs, const wire::Status& status) {
  const FleetView view{.ready = status.ready(),
                       .queued = static_cast<int>(jobs.queued.size()),
                       .running = static_cast<int>(jobs.running.size()),
                       .hands_out = status.state() == "running" && !status.paused()};
  const int more = moreWorkers(view, options_.limits);
  if (more <= 0) return more;
  if (isUnheard(jobs, status)) return 0;
  return std::clamp(launches_.mostUnproven(Clock::now()) - unproven(jobs), 0, more);
}

/// Returns true if jobs run but no worker has connected: more jobs would not help.
bool SlurmFleet::isUnheard(const SlurmJobs& jobs, const wire::Status& status) {
  const auto isOld = [](const Launches::Running& job) { return job.age >= long_unheard; };
  const bool unheard = status.workers().empty() && std::ranges::any_of(jobs.running, isOld) &&
                       status.seconds() >= static_cast<double>(long_unheard.count());
  if (unheard && !told_unheard_)
    spdlog::warn(
        "jobs have run for a minute, but no worker has connected to the scheduler; no more jobs "
        "are submitted. Can their nodes reach {} (--connect, firewall)? Are their keys allowed "
        "(palpate key)? {}",
        options_.endpoint, wroteOf(engine_.logOf(std::ranges::find_if(jobs.running, isOld)->id)));
  told_unheard_ = unheard;
  return unheard;
}

/// Cancels jobs for another endpoint. Also cancels the queued jobs if nodes have just been
/// excluded, or if no job may start now. Returns false if there was nothing to cancel.
bool SlurmFleet::cancelUnwanted(const SlurmJobs& jobs, bool nodes_changed) {
  std::vector<std::string> ids = jobs.elsewhere;
  if (!ids.empty())
    spdlog::warn("{} jobs connect to another endpoint than {} and are cancelled", ids.size(),
                 options_.endpoint);
  // A queued job keeps the list of excluded nodes with which it was submitted.
  if (nodes_changed || launches_.mostUnproven(Clock::now()) == 0)
    std::ranges::transform(jobs.queued, std::back_inserter(ids), &SlurmJobs::Queued::id);
  engine_.cancel(ids);
  return !ids.empty();
}

void SlurmFleet::tell(const SlurmJobs& jobs, int more, const std::string& why) {
  const std::string text =
      fmt::format("{} workers running, {} queued{}; {}: {}", jobs.running.size(),
                  jobs.queued.size(), reasonsOf(jobs), why,
                  more > 0   ? fmt::format("{} more", more)
                  : more < 0 ? fmt::format("{} queued not needed", -more)
                             : "no change");
  if (options_.dry_run)
    fmt::print("{}\n{}", text,
               more > 0 ? engine_.script(std::min(more, 1000), launches_.badNodes()) : "");
  else if (text != told_)
    spdlog::info("{}", text);
  told_ = text;
}

void SlurmFleet::tellLaunches(const Launches::Change& change) {
  const std::deque<Launches::Ended>& failures = launches_.failures();
  for (const std::string& node : change.left_out) {
    const auto last =
        std::ranges::find(failures.rbegin(), failures.rend(), node, &Launches::Ended::node);
    spdlog::warn(
        "node {} is excluded (sbatch --exclude): jobs fail there within {} s of their start, but "
        "run on other nodes{}. After its repair, start this command again",
        node, Launches::early.count(),
        last == failures.rend() ? ""
                                : fmt::format("; last failure: {}; {}", nameOf(*last),
                                              wroteOf(engine_.logOf(last->id))));
  }
  if (!change.held || failures.empty()) return;
  spdlog::warn(
      "jobs fail within {} s of their start, the last ones: {}. The next job is submitted alone, "
      "in {} s; the intervals grow until a job survives. {}",
      Launches::early.count(), fmt::join(mapped(failures, nameOf), ", "), launches_.pause().count(),
      wroteOf(engine_.logOf(failures.back().id)));
}

void SlurmFleet::end() {
  const auto until = Clock::now() + seconds(options_.give_up_s);
  for (std::string told;;) {
    std::string left;
    bool refused = false;  // refused until an option is changed
    try {
      engine_.cancelAll();
      const SlurmJobs jobs = engine_.jobs();
      const std::size_t count = jobs.queued.size() + jobs.running.size() + jobs.elsewhere.size();
      if (count == 0) return;
      left = fmt::format("{} jobs of {} have not ended yet", count, options_.slurm.name);
    } catch (const Error& error) {
      refused = error.exitCode() == ExitCode::usage;
      left = error.what();
    }
    if (refused || interrupted() || Clock::now() > until)
      throw Error(refused ? ExitCode::usage : ExitCode::failed,
                  fmt::format("{}: jobs may be left; later run scancel --me --name={}", left,
                              options_.slurm.name));
    if (left != told) spdlog::warn("{}; cancelling again", left);
    told = left;
    std::this_thread::sleep_for(seconds(1));
  }
}

ExitCode SlurmFleet::finish(const char* why) {
  if (!options_.dry_run) end();
  fmt::print("{}: no job of {} is left\n", why, options_.slurm.name);
  return ExitCode::done;
}

ExitCode SlurmFleet::leave() const {
  fmt::print(
      "stopped; the jobs of {} continue, and each worker leaves after {} s without work. The same "
      "command takes over the jobs; with --cancel it ends them.\n",
      options_.slurm.name, options_.leave_idle_s);
  return ExitCode::interrupted;
}

}  // namespace palpate
