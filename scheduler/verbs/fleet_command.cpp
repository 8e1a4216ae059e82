#include <spdlog/spdlog.h>

#include <memory>
#include <thread>

#include "common/base/number_text.hpp"
#include "common/base/required_option.hpp"
#include "scheduler/fleet/slurm_fleet.hpp"
#include "scheduler/fleet/ssh.hpp"
#include "scheduler/state/tables.hpp"
#include "scheduler/verbs/verbs.hpp"

// `palpate fleet`: starts as many workers as a build can use, through Slurm or ssh.

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

// ---- Command line ----

/// Adds an option for a number from 1 to `most`. --help shows its default.
void addCount(CLI::App& app, const char* name, int& count, int most, const char* help) {
  app.add_option(name, count, help)->check(CLI::Range(1, most))->capture_default_str();
}

void addCommon(CLI::App& app, FleetOptions& options) {
  options.asked.addTo(app);
  app.add_option("--connect", options.endpoint,
                 "Scheduler address for workers, tcp://HOST:PORT [WHERE]");
  addCount(app, "--every", options.every_s, 3600, "Seconds between two queries of the scheduler");
  addCount(app, "--give-up", options.give_up_s, 7 * 24 * 3600,
           "End all workers after this many seconds without an answer");
  app.add_flag("--dry-run", options.dry_run, "Print what would be done, and do nothing");
}

struct SlurmOrder : SlurmFleetOptions {
  void addTo(CLI::App& app) {
    addCommon(app, *this);
    addCount(app, "--most", limits.most, 100000, "Maximum number of workers, one core each");
    addCount(app, "--backlog", limits.most_queued, 100000, "Maximum number of queued workers");
    addCount(app, "--each", limits.transitions_each, 100000,
             "Request one more worker for every N solves that are ready to start");
    addCount(app, "--minutes", slurm.minutes, 60 * 24 * 30, "Time limit of each job, minutes");
    addCount(app, "--leave-idle", leave_idle_s, 24 * 3600,
             "Seconds without work after which a worker leaves");
    app.add_option("--constraint", slurm.constraint, "Required features of nodes, as for sbatch");
    app.add_option("--log", slurm.log, "Output file of the workers, as for sbatch")
        ->capture_default_str();
    app.add_flag("--cancel", cancel, "End all jobs of this build");
    app.add_option("SBATCH", slurm.more,
                   "Options for sbatch, after --: -- --partition=short --account=me");
    app.footer(
        "Runs until the build is complete, and then leaves no job behind. You can end it and start\n"
        "it again at any time, even while the scheduler restarts: it stores nothing.");
  }
};

struct SshOrder : FleetOptions {
  SshOptions ssh;
  std::vector<std::string> hosts;
  std::string program = "palpate";  ///< as the remote shell finds it

  void addTo(CLI::App& app) {
    addCommon(app, *this);
    addRequired(app, "--hosts", hosts,
                "Machines for ssh, HOST or USER@HOST; HOST:N starts N workers [one per core]");
    app.add_option("--program", program, "Path or name of palpate on the machines")
        ->capture_default_str();
    app.add_option("SSH", ssh.more, "Options for ssh, after --: -- -p 2222 -i KEY");
    app.footer(
        "Runs until the build is complete or you interrupt it, and then leaves no worker behind.\n"
        "Machines that cannot be reached are tried again. ssh must not ask questions: set up keys,\n"
        "and accept the host keys of the machines beforehand.");
  }
};

/// Time for a worker to deliver its results. Slurm kills a cancelled job after 30 s (KillWait) by
/// default.
constexpr int seconds_to_deliver = 25;

/// Returns the scheduler's status and sets the endpoint that nodes connect to. Throws Error if the
/// scheduler does not answer.
wire::Status meet(FleetOptions& options) {
  const auto status = FleetWatch(options).look();
  if (!status && interrupted()) throw Error(ExitCode::interrupted, "interrupted");
  if (!status) throw failure("{}: does not answer, see above", options.asked.where);
  // A complete build needs no workers, and its scheduler may be gone.
  if (status->state() == "complete") return *status;
  if (options.endpoint.empty()) {
    const auto scheduler = schedulerOf(options.asked);
    options.endpoint = scheduler ? scheduler->endpoint : options.asked.where;
  }
  checkEndpoint(options.endpoint);
  if (isOnThisMachineOnly(options.endpoint))
    spdlog::warn("{} is local to this machine: give --connect if workers run elsewhere",
                 options.endpoint);
  return *status;
}

/// Returns the command that a machine runs. `palpate` checks the memory limit before it starts a
/// worker.
std::vector<std::string> workerCommand(const std::string& palpate, const FleetOptions& options) {
  std::vector<std::string> words = {palpate,     "work",
                                    "--connect", options.endpoint,
                                    "--drain",   std::to_string(seconds_to_deliver)};
  if (options.asked.keys.insecure) words.emplace_back("--insecure");
  return words;
}

/// Returns the id of the build. Cancelling its jobs needs no scheduler, because the state directory
/// also names the build.
std::string buildOf(SlurmFleetOptions& options) {
  const std::filesystem::path state = options.asked.where;
  if (options.cancel && std::filesystem::is_directory(state))
    return StoredTables(state).build().build.hex();
  return meet(options).build();
}

ExitCode runSlurm(SlurmFleetOptions& options) {
  catchInterrupts();
  options.slurm.name = "palpate-" + buildOf(options).substr(0, 12);
  options.slurm.endpoint = options.endpoint;
  std::vector<std::string>& command = options.slurm.command;
  command = workerCommand(programBeside("palpate").string(), options);
  command.insert(command.end(), {"--leave-idle", std::to_string(options.leave_idle_s)});
  if (const std::string& folder = options.asked.keys.folder; !folder.empty())
    command.insert(command.end(), {"--keys", std::filesystem::absolute(folder).string()});
  SlurmFleet fleet(options);
  if (!options.cancel) return fleet.run();
  fleet.end();
  fmt::print("no job of {} is left\n", options.slurm.name);
  return ExitCode::done;
}

// ---- ssh ----

ExitCode keepHosts(const SshOrder& options, SshHosts& hosts) {
  // The time that workers have to deliver, and 5 s for the connection.
  constexpr std::chrono::seconds grace{seconds_to_deliver + 5};
  FleetWatch watch(options);
  for (Clock::time_point next_look;;) {
    const auto now = Clock::now();
    hosts.keep(now);
    if (interrupted()) {
      hosts.terminate(grace);
      fmt::print(
          "stopped; the workers of this command were ended, and the build continues with others\n");
      return ExitCode::interrupted;
    }
    if (hosts.done()) break;
    if (now >= next_look) {
      next_look = now + std::chrono::seconds(options.every_s);
      const auto status = watch.look();
      if (status && status->state() == "complete") break;
      if (!status && watch.gaveUp()) {
        hosts.terminate(grace);
        throw failure("{}: no longer answers; the workers were ended", options.asked.where);
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  // The scheduler has told the workers to leave, so wait until they have ended.
  for (const auto until = Clock::now() + grace; hosts.running() > 0 && Clock::now() < until;) {
    hosts.keep(Clock::now());
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  hosts.terminate(std::chrono::milliseconds(0));
  fmt::print("the build is complete: no worker is left on {}\n",
             counted(options.hosts.size(), "machine"));
  return ExitCode::done;
}

ExitCode runSsh(SshOrder& options) {
  for (const std::string& host : options.hosts) SshHosts::checkHost(host);
  catchInterrupts();
  if (meet(options).state() == "complete") {
    fmt::print("the build is complete: there is nothing to do\n");
    return ExitCode::done;
  }
  options.ssh.command = workerCommand(options.program, options);
  SshHosts hosts(options.ssh, options.hosts);
  if (!options.dry_run) return keepHosts(options, hosts);
  for (const std::string& host : options.hosts)
    fmt::print("{}\n", SshHosts::told(options.ssh, host));
  return ExitCode::done;
}

template <class Options, auto run>
void addEngine(CLI::App& app, const char* name, const char* what,
               const std::shared_ptr<std::function<ExitCode()>>& chosen) {
  CLI::App& engine = *app.add_subcommand(name, what);
  engine.callback([chosen, run_it = prepareVerb<Options, run>(engine)] { *chosen = run_it; });
}

std::function<ExitCode()> prepareFleet(CLI::App& app) {
  const auto chosen = std::make_shared<std::function<ExitCode()>>();
  addEngine<SlurmOrder, runSlurm>(app, "slurm", "Start workers as jobs of Slurm", chosen);
  addEngine<SshOrder, runSsh>(app, "ssh", "Start workers on other machines by ssh", chosen);
  app.require_subcommand(1);
  return [chosen] { return (*chosen)(); };
}

}  // namespace

const Verb fleet_verb = {"fleet", "Start as many workers as a build can use, by Slurm or ssh",
                         prepareFleet};

}  // namespace palpate
