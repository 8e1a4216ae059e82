#include "scheduler/build.hpp"

#include <spdlog/spdlog.h>
#include <sys/ioctl.h>

#include <CLI/CLI.hpp>

#include "common/base/assertion.hpp"
#include "common/base/replaced_file.hpp"
#include "common/problem/problem_warnings.hpp"
#include "scheduler/state/replay.hpp"
#include "scheduler/status_text.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds redraw_every{200};
/// Into a file: a night of work is a thousand lines.
constexpr std::chrono::milliseconds line_every{30000};

/// Asked anew for every line: windows are resized.
std::size_t columnsOf(int terminal) {
  constexpr std::size_t usual = 80;
  struct winsize size {};
  return ioctl(terminal, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : usual;
}

/// Shows on stderr how far a build is: a bar that redraws itself in one row of a terminal, else a
/// line every half minute. Nothing when only warnings are wanted (--quiet).
class Progress {
 public:
  Progress() {
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
      fmt::print(stderr, "\r{}\x1b[K", progressBar(status, columnsOf(STDERR_FILENO)));
    else
      fmt::print(stderr, "{}\n", progressLine(status));
    drawn_ = terminal_;
  }

  /// Ends the bar's line.
  void end() const {
    if (drawn_) fmt::print(stderr, "\n");
  }

 private:
  const bool wanted_ = spdlog::get_level() <= spdlog::level::info;
  const bool terminal_ = isatty(STDERR_FILENO) == 1;
  bool drawn_ = false;
  Clock::time_point next_ = Clock::now();
};

/// True when `file` is the dataset of this build already, false when there is no such file, or when
/// it is that but stores something else (Storage) than asked for. Error (bad input) when it is
/// anything else, unless `force`.
bool isSealed(const std::filesystem::path& file, const Problem& problem, bool force) {
  if (!std::filesystem::exists(file)) return false;
  const ContentId build = problemId(problem);
  std::string what;
  try {
    const Dataset dataset(file);
    if (dataset.buildId() == build) {
      // A damaged file is no finished work: it would be found out only when somebody touches it.
      dataset.verifyAll();
      return dataset.scene().storage == problem.scene.storage;
    }
    what =
        fmt::format("holds the dataset of another scene or mesh (build {} of scene \"{}\", not {})",
                    dataset.buildId().shortHex(), dataset.scene().name, build.shortHex());
  } catch (const Error& error) {
    what = fmt::format("exists and is not a usable dataset ({})", error.what());
  }
  if (!force)
    throw badInput("{}: {}: give another -o, or --force to replace it", file.string(), what);
  return false;
}

ExitCode finish(const std::vector<SpaceTable>& spaces, const Scene& scene,
                const std::filesystem::path& out, const std::string& how) {
  PALPATE_ASSERT(!spaces.empty(), "a scene has something to touch, and each of it a space");
  fmt::print("{}\n{}: {}\nnext: palpate query '{}' --active {} --displacement {:.3g} 0 0\n",
             summaryOf(spaces, scene), out.string(), how, out.string(), spaces.front().patch.name,
             scene.workspace.spacing / 2);
  return exitCodeOf(spaces);
}

}  // namespace

Build::Build(Problem problem, const std::filesystem::path& state, CoordinatorSettings settings)
    : problem_(std::move(problem)),
      problem_bytes_(encodeProblem(problem_)),
      directory_(state),
      store_(directory_, problem_, problem_bytes_),
      journal_(directory_.path(), store_.committed()),
      coordinator_(problem_, problem_bytes_, store_, journal_, Clock::now(), settings) {}

std::vector<SpaceTable> Build::seal(const std::filesystem::path& file) {
  PALPATE_ASSERT(coordinator_.complete(), "a dataset holds every point of its scene");
  const std::vector<SpacePlan>& plans = coordinator_.plans();
  std::vector<SpaceTable> tables = spaceTables(plans);
  const auto fields = [&](std::size_t space, std::int32_t point) {
    const auto kept =
        store_.find({static_cast<std::uint32_t>(space), point, plans[space].point(point).parent});
    PALPATE_ASSERT(kept, "a plan moves on with recorded results only");
    return NodalFields::decode(journal_.read(kept->where).payload, problem_.mesh.nodes.size(),
                               pressureNodes(problem_));
  };
  sealDataset(file, problem_, tables, store_.build().kernel_family, fields);
  return tables;
}

void addOptions(CLI::App& app, BuildOrder& order) {
  app.add_option("SCENE", order.scene, "The scene, a TOML file (docs/scene.md)")
      ->required()
      ->type_name("FILE");
  app.add_option("-o,--output", order.out,
                 "Dataset to make [the scene's name with .h5, in the current directory]");
  app.add_option("--state", order.state,
                 "Directory for unfinished work, on a local disk [OUTPUT.state]");
  app.add_flag("--force", order.force, "Replace OUTPUT when it holds something else");
}

ExitCode carryOut(const BuildOrder& order, const std::string& endpoint,
                  const std::function<ExitCode(Server&, Coordinator&)>& compute) {
  Problem problem = loadProblem(order.scene);
  logWarnings(problem);
  const std::filesystem::path out = order.out.empty() ? problem.scene.name + ".h5" : order.out;
  const std::string state = order.state.empty() ? out.string() + ".state" : order.state;
  if (isSealed(out, problem, order.force))
    return finish(Dataset(out).spaces(), problem.scene, out,
                  "is already the dataset of this scene; nothing to do");
  // Before the state directory is made, and before hours of work.
  refuseUnwritable(out, "-o");

  catchInterrupts();
  const auto began = Clock::now();
  Build build(std::move(problem), state);
  Coordinator& coordinator = build.coordinator();
  if (!coordinator.complete()) {
    if (coordinator.found() > 0)
      spdlog::info("going on: {} results are recorded in {}", coordinator.found(), state);
    zmq::context_t context;
    Server server(context, endpoint);
    build.directory().announce(server.endpoint());
    const ExitCode when_stopped = compute(server, coordinator);
    if (!coordinator.complete()) {
      fmt::print(stderr,
                 "stopped; everything finished is kept in {}. "
                 "The same command goes on from there.\n",
                 state);
      return when_stopped;
    }
  }
  const std::vector<SpaceTable> spaces = build.seal(out);
  const double seconds = std::chrono::duration<double>(Clock::now() - began).count();
  return finish(spaces, build.problem().scene, out, fmt::format("sealed after {:.1f} s", seconds));
}

void serveUntilDone(Server& server, Coordinator& coordinator,
                    const std::function<void()>& each_turn) {
  Progress progress;
  while (!coordinator.complete() && !coordinator.stopping()) {
    server.turn(coordinator, longest_turn);
    if (each_turn) each_turn();
    progress.show(coordinator);
    if (interrupted()) coordinator.stop(Clock::now());
  }
  progress.end();
}

ExitCode exitCodeOf(const std::vector<SpaceTable>& spaces) {
  const auto failedWhenTried = [](const PointRecord& point) {
    return point.tag == Tag::failed && point.cause != Cause::unreachable;
  };
  const bool failed = std::ranges::any_of(spaces, [&](const SpaceTable& space) {
    return std::ranges::any_of(space.points, failedWhenTried);
  });
  return failed ? ExitCode::partly_failed : ExitCode::done;
}

}  // namespace palpate
