#include "scheduler/verbs/served_build.hpp"

#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/cpu_family.hpp"
#include "common/base/index.hpp"
#include "common/base/number_text.hpp"
#include "common/base/required_option.hpp"
#include "common/base/terminal.hpp"
#include "common/base/text.hpp"
#include "common/base/whole_file.hpp"
#include "common/problem/problem_warnings.hpp"
#include "scheduler/builds/changed_scene.hpp"
#include "scheduler/verbs/status_text.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

// ---- Output ----

constexpr std::chrono::milliseconds redraw_every{200};
/// Interval of progress lines in a file: about a thousand lines per night.
constexpr std::chrono::milliseconds line_every{30000};

/// Prints a message for the user, or logs a warning if the log is JSON.
template <class... Args>
void tellOrLog(fmt::format_string<Args...> text, Args&&... args) {
  const std::string line = fmt::format(text, std::forward<Args>(args)...);
  if (logIsJson())
    spdlog::warn("{}", line);
  else
    tell("{}\n", line);
}

/// Shows progress on stderr: a bar in one row of a terminal, else a line every 30 s. Shows nothing
/// with --quiet.
class ShownProgress {
 public:
  ShownProgress() {
    // Log lines would break up the bar, so show only warnings.
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

  /// Ends the line of the bar.
  void end() const {
    if (drawn_) tell("\n");
  }

 private:
  const bool wanted_ = spdlog::get_level() <= spdlog::level::info;
  const bool terminal_ = isatty(STDERR_FILENO) == 1 && !logIsJson();
  bool drawn_ = false;
  Clock::time_point next_ = Clock::now();
};

/// Returns the arguments of an example query: a displacement of half a spacing along x or, for a
/// finger, into the surface.
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

/// Tells the user why the build in `state` ended without a dataset, and how to resume it.
void tellWhyNotSealed(const Coordinator& coordinator, const std::string& state) {
  if (!coordinator.stuck())
    return tellOrLog("stopped; all results are kept in {}. The same command continues from there.",
                     state);
  if (coordinator.disputedCount() > 0)
    tellOrLog(
        "not sealed: workers disagree about {} (see above), and no other worker can "
        "decide. The same command solves them again; if possible, add a third machine.",
        counted(coordinator.disputedCount(), "result"));
  if (coordinator.asideCount() > 0)
    tellOrLog(
        "not sealed: workers died on {}; everything else is computed (see above, and palpate "
        "status {}). After you remove the reason, run palpate retry {} and the same command again.",
        counted(coordinator.asideCount(), "transition"), shellWord(state), shellWord(state));
}

// ---- The build ----

/// Limits both the load of idle turns and the delay until a signal of the terminal is handled.
constexpr std::chrono::milliseconds longest_turn{50};

/// Returns the name that results give to the family `kernels`, and logs the consequence for
/// workers. Returns an empty string if the user chose no family.
std::string chosenKernels(const std::string& kernels) {
  for (const CpuFamily family : all_cpu_families) {
    if (name(family) != kernels) continue;
    // docs/evaluation.md gives the measured factors.
    constexpr std::array who = {
        "all machines can join; those with AVX2 or AVX-512 take about 1.3 times as long as with "
        "their own kernels",
        "machines without AVX2 are refused; those with AVX-512 take up to 1.1 times as long as "
        "with their own kernels",
        "machines without AVX-512 are refused"};
    spdlog::info("using the {} kernels: {}", arithmeticOf(family),
                 who[static_cast<std::size_t>(family)]);
    return arithmeticOf(family);
  }
  return "";
}

/// Returns the tables of a dataset, including the places where areas are measured.
std::vector<SpaceTable> spacesAndProbes(const Dataset& dataset) {
  std::vector<SpaceTable> all = dataset.spaces();
  all.insert(all.end(), dataset.probePlaces().begin(), dataset.probePlaces().end());
  return all;
}

/// Raises the limit of open files to its maximum: every peer needs a descriptor, and the usual
/// limit is 1024.
void allowAsManyPeers() {
  struct rlimit limit {};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) throw failure("getrlimit: {}", errnoText());
  limit.rlim_cur = limit.rlim_max;
  if (setrlimit(RLIMIT_NOFILE, &limit) != 0)
    spdlog::warn("cannot raise the limit of open files to {}: {}", limit.rlim_cur, errnoText());
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

/// Opens the recorded results, serves the build, seals the dataset and lets the workers leave.
class ServedBuild {
 public:
  ServedBuild(const BuildOrder& order, Serving serving)
      : order_(order),
        serving_(std::move(serving)),
        problem_(loadProblem(order_.scene)),
        out_(order_.out.empty() ? problem_.scene.name + ".h5" : order_.out),
        state_(order_.state.empty() ? out_.string() + ".state" : order_.state),
        events_(state_) {
    logWarnings(problem_);
  }

  ExitCode run() {
    setAsideWhatIsOfAnotherScene(out_, state_, problem_, order_.replace);
    if (isSealed(out_, problem_, order_.replace))
      return sealed(rowsOf(spacesAndProbes(Dataset(out_))),
                    "is already the dataset of this scene; nothing to do");
    // Check this now, before creating the state directory and computing for hours.
    refuseUnwritable(out_, "-o");
    catchInterrupts();
    for (const CoordinatorSettings all = settings();; serving_.anew())
      if (const auto code = attempt(all)) return *code;
  }

 private:
  CoordinatorSettings settings() {
    CoordinatorSettings settings;
    settings.keys_tell_who = !serving_.own_keys;
    settings.spot_checks.share = order_.spot_checks_percent / 100;
    if (serving_.keys) settings.spot_checks.trusted_key = serving_.keys->ownOrNew().open();
    settings.kernel_family = chosenKernels(order_.kernels);
    if (order_.hung_after_s) settings.hung_after = std::chrono::seconds(*order_.hung_after_s);
    settings.events = &events_;
    return settings;
  }

  /// Runs the build once. Returns none if the build must restart from the recorded results.
  std::optional<ExitCode> attempt(const CoordinatorSettings& settings) {
    Build build(problem_, state_, Clock::now(), settings);
    Coordinator& coordinator = build.coordinator();
    events_.add(startedEvent(build));
    events_.flush();
    if (stopping_) coordinator.stop(Clock::now());
    try {
      const SpaceRowsList rows = coordinator.complete() ? build.seal(out_) : serve(build);
      if (coordinator.next() != Next::anew) {
        if (rows.empty()) return stopped(coordinator);
        const double seconds = std::chrono::duration<double>(Clock::now() - began_).count();
        events_.add(Event("sealed").with("file", out_.string()).with("seconds", seconds));
        return sealed(rows, fmt::format("sealed after {:.1f} s", seconds));
      }
      build.keepOut(coordinator.liars());
    } catch (const DamagedRecord& damage) {
      spdlog::warn("{}; it is dropped, and its result computed again", damage.what());
      events_.add(Event("damaged").with("text", damage.what()));
      build.drop(damage);
    } catch (const std::exception& error) {
      events_.add(Event("stopped").with("reason", error.what()));
      throw;
    }
    stopping_ = coordinator.stopping();
    return std::nullopt;
  }

  /// Returns the rows of the dataset; none if the build was stopped, is stuck, or must restart.
  SpaceRowsList serve(Build& build) {
    Coordinator& coordinator = build.coordinator();
    zmq::context_t context;
    const std::unique_ptr<Server> server = open(context, build);
    const std::unique_ptr<Crew> crew = serving_.crew(*server, build);
    work(*server, coordinator, *crew);
    crew->pause(coordinator.next());
    SpaceRowsList rows;
    if (coordinator.next() == Next::complete) rows = seal(*server, build);
    drain(*server, coordinator, *crew);
    return rows;
  }

  /// Opens a server at the endpoint, and stores the chosen port in the endpoint.
  std::unique_ptr<Server> open(zmq::context_t& context, Build& build) {
    const Coordinator& coordinator = build.coordinator();
    if (coordinator.found() > 0)
      spdlog::info("continuing from {} results recorded in {}", coordinator.found(), state_);
    if (coordinator.paused())
      spdlog::warn("paused by an operator; to continue, run palpate resume {}", shellWord(state_));
    allowAsManyPeers();
    if (serving_.own_keys) {
      serving_.keys = KeyFolder(build.directory().keys());
      // These keys last for one run, so a damaged key file does not stop it.
      serving_.keys->replaceOwn();
    }
    auto server =
        std::make_unique<Server>(context, build.problem(), serving_.endpoint, serving_.keys);
    serving_.endpoint = server->endpoint();
    build.directory().announce({serving_.endpoint, serving_.keys});
    return server;
  }

  /// Answers messages and shows progress until the build is complete, is stuck, is stopped by a
  /// message or a signal, or must restart.
  void work(Server& server, Coordinator& coordinator, Crew& crew) {
    ShownProgress progress;
    while (coordinator.next() == Next::go_on) {
      if (server.turn(coordinator, longest_turn) == Next::anew) break;
      crew.look();
      progress.show(coordinator);
      if (interrupted()) coordinator.stop(Clock::now());
    }
    PALPATE_ASSERT(coordinator.next() != Next::go_on, "only a stop or a restart may end the loop");
    if (coordinator.next() == Next::stuck) coordinator.dismiss();
    progress.end();
  }

  SpaceRowsList seal(Server& server, Build& build) {
    // Verify while workers are available to compute a damaged result again.
    build.verify();
    build.coordinator().dismiss();
    // A message in this turn may ask for failures to be tried again.
    if (server.turn(build.coordinator(), std::chrono::milliseconds(0)) == Next::anew) return {};
    return build.seal(out_);
  }

  /// Lets workers finish their jobs and leave. Does not wait if the build is about to restart.
  void drain(Server& server, Coordinator& coordinator, Crew& crew) {
    const auto deadline = Clock::now() + serving_.drain_limit;
    while (coordinator.next() != Next::anew && crew.isThere() && Clock::now() < deadline)
      server.turn(coordinator, longest_turn);
    if (coordinator.next() != Next::anew) crew.end();
  }

  ExitCode stopped(const Coordinator& coordinator) {
    const bool stuck = coordinator.stuck();
    events_.add(Event("stopped")
                    .with("reason", stuck           ? "stuck"
                                    : interrupted() ? "signal"
                                                    : "asked")
                    .with("recorded", coordinator.recorded()));
    tellWhyNotSealed(coordinator, state_);
    return stuck ? ExitCode::failed : interrupted() ? ExitCode::interrupted : serving_.when_stopped;
  }

  ExitCode sealed(const SpaceRowsList& rows, const std::string& how) const {
    PALPATE_ASSERT(!rows.empty(), "a scene must have an active node");
    fmt::print("{}\n{}: {}\nnext: palpate query {} {}\n", summaryOf(rows, problem_.scene),
               out_.string(), how, shellWord(out_.string()),
               exampleOf(rows.front()->patch(), problem_.scene));
    return exitCodeOf(rows);
  }

  const BuildOrder& order_;
  Serving serving_;
  const Problem problem_;
  const std::filesystem::path out_;
  const std::string state_;
  EventLog events_;
  const Clock::time_point began_ = Clock::now();
  bool stopping_ = false;  ///< a stop was requested; it also holds after a restart
};

}  // namespace

void BuildOrder::addTo(CLI::App& app) {
  addRequired(app, "SCENE", scene, "Scene, a TOML file (docs/scene.md)", "FILE");
  app.add_option("-o,--output", out,
                 "Dataset to write [the scene's name with .h5, in the current directory]");
  app.add_option("--state", state, "State directory, on a local disk [OUTPUT.state]");
  app.add_flag("--replace", replace, "Replace OUTPUT if it holds something else");
  app.add_option("--hung-after", hung_after_s,
                 "Time limit of a solve in seconds; then its worker ends and another one takes "
                 "over [30 times the longest solve so far, at least 120]")
      ->check(CLI::Range(1U, 7U * 24 * 3600));
  app.add_option("--kernels", kernels, "Instruction set of all workers [that of the first result]")
      ->check(CLI::IsMember(
          mapped(all_cpu_families, [](CpuFamily family) { return std::string(name(family)); })));
}

ExitCode serveBuild(const BuildOrder& order, Serving serving) {
  return ServedBuild(order, std::move(serving)).run();
}

}  // namespace palpate
