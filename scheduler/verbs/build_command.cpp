#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include "common/base/assertion.hpp"
#include "common/base/cpu_family.hpp"
#include "common/base/machine.hpp"
#include "common/base/number_text.hpp"
#include "common/base/terminal.hpp"
#include "common/base/text.hpp"
#include "common/base/whole_file.hpp"
#include "common/keys/key_options.hpp"
#include "common/problem/problem_warnings.hpp"
#include "scheduler/builds/build.hpp"
#include "scheduler/builds/changed_scene.hpp"
#include "scheduler/fleet/worker_pool.hpp"
#include "scheduler/verbs/served_pages.hpp"
#include "scheduler/verbs/service_manager.hpp"
#include "scheduler/verbs/status_text.hpp"
#include "scheduler/verbs/verbs.hpp"

namespace palpate {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

// ---- What build and serve do alike ----

/// Long enough to rest, short enough for the signals of a terminal.
constexpr milliseconds longest_turn{50};

constexpr milliseconds redraw_every{200};
/// Into a file: a night of work is a thousand lines.
constexpr milliseconds line_every{30000};

/// For people, or, where programs read the log, a line of it.
template <class... Args>
void tellOrLog(fmt::format_string<Args...> text, Args&&... args) {
  const std::string line = fmt::format(text, std::forward<Args>(args)...);
  if (logIsJson())
    spdlog::warn("{}", line);
  else
    tell("{}\n", line);
}

/// Shows on stderr how far a build is: a bar that redraws itself in one row of a terminal, else a
/// line every half minute. Nothing when only warnings are wanted (--quiet).
class ShownProgress {
 public:
  ShownProgress() {
    // Log lines would tear the bar apart.
    if (wanted_ && terminal_ && spdlog::get_level() == spdlog::level::info)
      spdlog::set_level(spdlog::level::warn);
  }

  void show(const Coordinator& coordinator) {
    const auto now = Clock::now();
    if (!wanted_ || now < next_) return;
    next_ = now + (terminal_ ? redraw_every : line_every);
    const wire::Status status = coordinator.status(now);
    if (terminal_)
      tell("\r{}\x1b[K", progressBar(status, sizeOf(STDERR_FILENO).columns));
    else if (logIsJson())
      spdlog::info("{}", progressLine(status));
    else
      tell("{}\n", progressLine(status));
    drawn_ = terminal_;
  }

  /// Ends the bar's line.
  void end() const {
    if (drawn_) tell("\n");
  }

 private:
  const bool wanted_ = spdlog::get_level() <= spdlog::level::info;
  const bool terminal_ = isatty(STDERR_FILENO) == 1 && !logIsJson();
  bool drawn_ = false;
  Clock::time_point next_ = Clock::now();
};

/// What can be asked of a space: half a spacing along x, or into the surface under a finger.
std::string exampleOf(const ActivePatch& patch, const Scene& scene) {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  std::string what = patch.name;
  if (patch.finger) {
    const auto site = std::ranges::find(scene.active, patch.name, &ActiveSelection::name);
    if (site != scene.active.end() && !site->area.empty()) what = site->area;
    what += " --at " + vectorText(patch.finger->center, 4, " ");
    if (!patch.finger->reach.outward.isZero()) direction = -patch.finger->reach.outward;
  }
  return fmt::format("--active {} --displacement {}", what,
                     vectorText(scene.workspace.spacing / 2 * direction, 3, " "));
}

std::vector<SpaceTable> spacesAndProbes(const Dataset& dataset) {
  std::vector<SpaceTable> all = dataset.spaces();
  all.insert(all.end(), dataset.probePlaces().begin(), dataset.probePlaces().end());
  return all;
}

ExitCode finish(const SpaceRowsList& spaces, const Scene& scene, const std::filesystem::path& out,
                const std::string& how) {
  PALPATE_ASSERT(!spaces.empty(), "a scene has something to touch, and each of it a space");
  fmt::print("{}\n{}: {}\nnext: palpate query {} {}\n", summaryOf(spaces, scene), out.string(), how,
             shellWord(out.string()), exampleOf(spaces.front()->patch(), scene));
  return exitCodeOf(spaces);
}

/// What `build` and `serve` are asked for alike.
struct BuildOrder {
  std::string scene;                     ///< a TOML file
  std::string out;                       ///< the dataset; empty: NAME.h5 in the current directory
  std::string state;                     ///< the state directory; empty: OUT.state
  bool replace = false;                  ///< replace `out` when it holds something else
  std::optional<unsigned> hung_after_s;  ///< of a solve; nothing: from what solves took so far
  double spot_checks_percent = 0;        ///< of all results, solved again by other machines
  std::string kernels;  ///< name of a CpuFamily; empty: those of the first result decide
};

std::vector<std::string> namesOfFamilies() {
  std::vector<std::string> names;
  for (const CpuFamily family : all_cpu_families) names.emplace_back(name(family));
  return names;
}

/// As results name it, and says what that means; empty: nobody chose.
std::string chosenKernels(const std::string& kernels) {
  for (const CpuFamily family : all_cpu_families) {
    if (name(family) != kernels) continue;
    // Times: docs/performance.md.
    constexpr std::array who = {
        "every worker may come; those with AVX2 or more take about 1.3 times as long as they could",
        "workers without AVX2 are refused; those with AVX-512 take up to 1.1 times as long as they "
        "could",
        "workers without AVX-512 are refused"};
    spdlog::info("computed with the {} kernels: {}", arithmeticOf(family),
                 who[static_cast<std::size_t>(family)]);
    return arithmeticOf(family);
  }
  return "";
}

/// Declares SCENE, -o, --state and --replace on `app`, which must not outlive `order`.
void addOptions(CLI::App& app, BuildOrder& order) {
  app.add_option("SCENE", order.scene, "The scene, a TOML file (docs/scene.md)")
      ->required()
      ->type_name("FILE");
  app.add_option("-o,--output", order.out,
                 "Dataset to make [the scene's name with .h5, in the current directory]");
  app.add_option("--state", order.state,
                 "Directory for unfinished work, on a local disk [OUTPUT.state]");
  app.add_flag("--replace", order.replace, "Replace OUTPUT when it holds something else");
  app.add_option(
         "--hung-after", order.hung_after_s,
         "A worker whose solve takes longer than so many seconds ends, and another is asked "
         "[30 times the longest so far, 120 at least]")
      ->check(CLI::Range(1U, 7U * 24 * 3600));
  app.add_option("--kernels", order.kernels,
                 "Instruction set that all workers compute with, newer machines too [that of the "
                 "first result]")
      ->check(CLI::IsMember(namesOfFamilies()));
}

/// Brings the build that a server works for to its end and calls `seal`, then lets the workers
/// leave. Unless it is stopped, or stuck: then it returns the exit code. Or another is to begin
/// anew (Next): then it returns at once.
using Compute = std::function<ExitCode(Server&, Build&, const std::function<void()>& seal)>;

/// Tells what the exit code of a build that came to no end means.
ExitCode tellWhy(const Coordinator& coordinator, const std::string& state, ExitCode when_stopped) {
  if (!coordinator.stuck()) {
    tellOrLog("stopped; everything finished is kept in {}. The same command goes on from there.",
              state);
    return when_stopped;
  }
  if (coordinator.disputedCount() > 0)
    tellOrLog(
        "not sealed: of {} result(s) workers found different bits (see above), and there is no "
        "other worker to say who is right. The same command again asks more of them; use a third "
        "machine where you can.",
        coordinator.disputedCount());
  if (coordinator.asideCount() > 0)
    tellOrLog(
        "not sealed: everything is computed but what workers ended on, {} transition(s) set aside "
        "(see above, and palpate status {}). When the reason is gone, palpate retry {} and the "
        "same command again try them anew.",
        coordinator.asideCount(), shellWord(state), shellWord(state));
  return ExitCode::failed;
}

/// Every peer takes a descriptor, and the usual limit is 1024.
void allowAsManyPeers() {
  struct rlimit limit {};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) throw failure("getrlimit: {}", errnoText());
  limit.rlim_cur = limit.rlim_max;
  if (setrlimit(RLIMIT_NOFILE, &limit) != 0)
    spdlog::warn("more than {} workers may not find room: {}", limit.rlim_cur, errnoText());
}

/// Where a server listens, and for whom.
struct Listening {
  std::string endpoint;
  bool own_keys = false;          ///< those of the state directory, which the server's workers get
  std::optional<KeyFolder> keys;  ///< else; nothing: for everybody
};

/// The rows of the dataset `out`, sealed by a server at `where`, which gets the port that was
/// chosen; none when the build was stopped or is stuck, and what
/// `compute` returned then.
std::pair<SpaceRowsList, ExitCode> sealedBy(const Compute& compute, Build& build, Listening& where,
                                            const std::filesystem::path& out,
                                            const std::string& state) {
  Coordinator& coordinator = build.coordinator();
  if (coordinator.complete()) return {build.seal(out), ExitCode::done};
  if (coordinator.found() > 0)
    spdlog::info("going on: {} results are recorded in {}", coordinator.found(), state);
  if (coordinator.paused())
    spdlog::warn("paused by an operator: nothing is computed before palpate resume {}",
                 shellWord(state));
  zmq::context_t context;
  allowAsManyPeers();
  if (where.own_keys) {
    where.keys = KeyFolder(build.directory().keys());
    // Of this run alone: a damaged one keeps nobody from going on.
    where.keys->replaceOwn();
  }
  Server server(context, build.problem(), where.endpoint, where.keys);
  where.endpoint = server.endpoint();
  build.directory().announce(
      {where.endpoint, where.keys ? std::optional(where.keys->path()) : std::nullopt});
  SpaceRowsList rows;
  const ExitCode when_stopped = compute(server, build, [&] {
    // As long as there are workers that could compute it again.
    build.verify();
    coordinator.dismiss();
    // A message of this turn may want failures tried again.
    if (server.turn(coordinator, milliseconds(0)) != Next::anew) rows = build.seal(out);
  });
  return {std::move(rows), when_stopped};
}

Event startedEvent(Build& build) {
  const Coordinator& coordinator = build.coordinator();
  return Event("started")
      .with("scene", build.problem().scene.name)
      .with("build", problemId(build.problem()).hex())
      .with("version", version())
      .with("pid", getpid())
      .with("found", coordinator.found())
      .with("paused", coordinator.paused());
}

Event stoppedEvent(const Coordinator& coordinator) {
  return Event("stopped")
      .with("reason", coordinator.stuck() ? "stuck"
                      : interrupted()     ? "signal"
                                          : "asked")
      .with("recorded", coordinator.recorded());
}

/// From the scene to the sealed dataset, which is what stdout then tells; nothing to do when `out`
/// is that already. Error before anything is computed when the scene is wrong, `out` holds
/// something else, or its folder is not there.
ExitCode carryOut(const BuildOrder& order, Listening where, const Compute& compute) {
  Problem problem = loadProblem(order.scene);
  logWarnings(problem);
  const std::filesystem::path out = order.out.empty() ? problem.scene.name + ".h5" : order.out;
  const std::string state = order.state.empty() ? out.string() + ".state" : order.state;
  setAsideWhatIsOfAnotherScene(out, state, problem, order.replace);
  if (isSealed(out, problem, order.replace))
    return finish(rowsOf(spacesAndProbes(Dataset(out))), problem.scene, out,
                  "is already the dataset of this scene; nothing to do");
  // Before the state directory is made, and before hours of work.
  refuseUnwritable(out, "-o");

  catchInterrupts();
  const auto began = Clock::now();
  CoordinatorSettings settings;
  settings.keys_tell_who = !where.own_keys;
  settings.spot_checks.share = order.spot_checks_percent / 100;
  if (where.keys) settings.spot_checks.trusted_key = where.keys->ownOrNew().open();
  settings.kernel_family = chosenKernels(order.kernels);
  if (order.hung_after_s) settings.hung_after = std::chrono::seconds(*order.hung_after_s);
  EventLog events(state);
  settings.events = &events;
  bool stopping = false;
  for (;;) {
    Build build(problem, state, Clock::now(), settings);
    events.add(startedEvent(build));
    events.flush();
    // Who was told so, and had to begin anew before it had.
    if (stopping) build.coordinator().stop(Clock::now());
    try {
      const Coordinator& coordinator = build.coordinator();
      const auto [rows, when_stopped] = sealedBy(compute, build, where, out, state);
      if (coordinator.next() != Next::anew) {
        if (rows.empty()) {
          events.add(stoppedEvent(coordinator));
          return tellWhy(coordinator, state, when_stopped);
        }
        const double seconds = std::chrono::duration<double>(Clock::now() - began).count();
        events.add(Event("sealed").with("file", out.string()).with("seconds", seconds));
        return finish(rows, build.problem().scene, out,
                      fmt::format("sealed after {:.1f} s", seconds));
      }
      build.keepOut(coordinator.liars());
    } catch (const DamagedRecord& damage) {
      spdlog::warn("{}: it is dropped, and computed again", damage.what());
      events.add(Event("damaged").with("text", damage.what()));
      build.drop(damage);
    } catch (const std::exception& error) {
      events.add(Event("stopped").with("reason", error.what()));
      throw;
    }
    stopping = build.coordinator().stopping();
  }
}

/// Answers messages and shows progress until the build is complete, stuck or stopped, by a message
/// or a signal, or another is to begin anew. `each_turn` is called a few times a second at least.
void serveUntilDone(Server& server, Coordinator& coordinator,
                    const std::function<void()>& each_turn = {}) {
  ShownProgress progress;
  while (coordinator.next() == Next::go_on) {
    if (server.turn(coordinator, longest_turn) == Next::anew) break;
    if (each_turn) each_turn();
    progress.show(coordinator);
    if (interrupted()) coordinator.stop(Clock::now());
  }
  if (coordinator.next() == Next::stuck) coordinator.dismiss();
  progress.end();
}

// ---- build ----

/// So many workers may end in a row without one new result. A target that kills its workers is
/// given up after fewer.
constexpr int deaths_without_progress = 20;
/// So many when none of them ever said hello: then it is not the work, it is the program.
constexpr int deaths_at_the_start = 3;
/// When none of them said hello by then, the program hangs.
constexpr std::chrono::minutes first_word_limit{2};

struct BuildOptions {
  BuildOrder order;
  int workers = static_cast<int>(coreCount());
};

ExitCode compute(Server& server, Build& build, const std::function<void()>& seal, int workers) {
  Coordinator& coordinator = build.coordinator();
  // How long workers may take to finish what they hold.
  constexpr milliseconds drain_limit{15000};
  WorkerPool pool({programBeside("palpate-worker").string(), "work", "--connect", server.endpoint(),
                   "--keys", build.directory().keys().string(), "--alone", "--quiet"});
  const auto started = Clock::now();
  for (int n = 0; n < workers; ++n) pool.start();

  std::int64_t recorded = 0;
  int deaths = 0;  // in a row
  bool joined = false;
  const auto replaceEnded = [&] {
    if (coordinator.recorded() > recorded) deaths = 0;
    recorded = coordinator.recorded();
    joined = joined || coordinator.workers() > 0;
    if (!joined && Clock::now() - started > first_word_limit)
      throw failure(
          "no worker said a word within {} min: see whether palpate-worker kernels answers on this "
          "machine, and raise limits of memory (ulimit -v)",
          first_word_limit.count());
    for (const WorkerPool::Ended& ended : pool.reap()) {
      if (coordinator.complete() || coordinator.stopping()) continue;
      coordinator.workerProcessEnded(static_cast<std::uint32_t>(ended.pid), Clock::now());
      if (++deaths >= (joined ? deaths_without_progress : deaths_at_the_start))
        throw failure(
            "{} workers in a row ended before they finished anything, the last with {}: "
            "see their messages above; the same command goes on from what is recorded",
            deaths, ended.how);
      spdlog::warn("worker {} ended with {}: starting another", ended.pid, ended.how);
      pool.start();
    }
  };
  serveUntilDone(server, coordinator, replaceEnded);
  if (coordinator.next() == Next::complete) seal();
  for (const auto deadline = Clock::now() + drain_limit;
       coordinator.next() != Next::anew && pool.running() > 0 && Clock::now() < deadline;
       pool.reap())
    server.turn(coordinator, longest_turn);
  // Whoever begins anew waits for none of them.
  if (coordinator.next() != Next::anew) pool.terminate(milliseconds(2000));
  return ExitCode::interrupted;
}

std::function<ExitCode()> prepareBuild(CLI::App& app) {
  auto options = std::make_shared<BuildOptions>();
  addOptions(app, options->order);
  app.add_option("-j,--workers", options->workers,
                 "Worker processes, one core each [number of cores]")
      ->check(CLI::Range(1, 4096));
  app.footer(
      "Interrupt it whenever you like: the same command goes on where it was.\n"
      "Exit codes: 0 done, 1 failed, 2 bad scene or usage, 3 done but some points failed, "
      "130 interrupted.");
  return [options] {
    return carryOut(options->order, {.endpoint = "tcp://127.0.0.1:*", .own_keys = true, .keys = {}},
                    [&](Server& server, Build& build, const std::function<void()>& seal) {
                      return compute(server, build, seal, options->workers);
                    });
  };
}

// ---- serve ----

/// What a service manager is told that reading of results, or sealing, may take: no turn is made
/// meanwhile.
constexpr std::chrono::hours longest_pause{1};
/// Before a Build that begins anew.
constexpr const char* going_over = "going over what is recorded";

struct ServeOptions {
  BuildOrder order;
  std::string endpoint = default_endpoint;
  KeyOptions keys;
  PageOptions pages;
};

ExitCode serve(Server& server, Build& build, const std::function<void()>& seal,
               ServiceManager& manager, ServedPages& pages) {
  Coordinator& coordinator = build.coordinator();
  // How long workers may take to finish what they hold and leave.
  constexpr std::chrono::seconds drain_limit{30};
  spdlog::info("listening on {}", server.endpoint());
  manager.ready();
  serveUntilDone(server, coordinator, [&] {
    const auto now = Clock::now();
    pages.offer(coordinator);
    manager.alive(now, [&] { return progressLine(coordinator.status(now)); });
  });
  const Next next = coordinator.next();
  manager.mayTake(longest_pause, next == Next::complete ? "sealing the dataset"
                                 : next == Next::anew   ? going_over
                                                        : "stopping");
  if (next == Next::complete) seal();
  for (const auto deadline = Clock::now() + drain_limit; coordinator.next() != Next::anew &&
                                                         !coordinator.deserted(Clock::now()) &&
                                                         Clock::now() < deadline;) {
    server.turn(coordinator, longest_turn);
    pages.offer(coordinator);
  }
  return interrupted() ? ExitCode::interrupted : ExitCode::done;
}

std::function<ExitCode()> prepareServe(CLI::App& app) {
  auto options = std::make_shared<ServeOptions>();
  addOptions(app, options->order);
  app.get_option("--state")->required()->description(
      "Directory for unfinished work, on a local disk");
  app.add_option("--listen", options->endpoint, "Where workers connect, tcp://HOST:PORT")
      ->capture_default_str();
  options->order.spot_checks_percent = 100 * SpotCheckSettings{}.share;
  app.add_option("--spot-checks", options->order.spot_checks_percent,
                 "Percent of the results that another machine solves again; 0: none")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 100.0));
  options->keys.addTo(app,
                      "Ask for no keys: whoever reaches the port takes and delivers work, and "
                      "stops the build");
  options->pages.addTo(app);
  app.footer(
      "Ends when the dataset is sealed, or when it is stopped; the same command then goes on.\n"
      "Exit codes: 0 done or stopped, 1 failed, 2 bad scene or usage, "
      "3 done but some points failed, 130 interrupted.");
  return [options] {
    checkEndpoint(options->endpoint);
    ServedPages pages(options->pages, options->order.state);
    ServiceManager manager;
    manager.mayTake(longest_pause, "reading what is recorded");
    const ExitCode code =
        carryOut(options->order,
                 {.endpoint = options->endpoint, .own_keys = false, .keys = options->keys.keys()},
                 [&](Server& server, Build& build, const std::function<void()>& seal) {
                   try {
                     return serve(server, build, seal, manager, pages);
                   } catch (...) {
                     // Something was damaged: all of it is read again.
                     manager.mayTake(longest_pause, going_over);
                     throw;
                   }
                 });
    // Else it would count as failed: there was nothing to do.
    manager.ready();
    manager.stopping();
    return code;
  };
}

}  // namespace

const Verb build_verb = {"build", "Compute the dataset of a scene with workers on this machine",
                         prepareBuild};

const Verb serve_verb = {"serve",
                         "Compute the dataset of a scene with workers that connect from anywhere",
                         prepareServe};

}  // namespace palpate
