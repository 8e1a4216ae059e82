#pragma once

#include "common/base/program.hpp"
#include "common/dataset/dataset.hpp"
#include "scheduler/service/server.hpp"
#include "scheduler/state/state_directory.hpp"

namespace palpate {

/// Everything one scheduler process has of a build: what the verbs `build` and `serve` share.
/// Holding it means holding the lock of the state directory.
class Build {
 public:
  /// Opens or makes the state of this problem in `state`, and goes on where the last run was.
  Build(Problem problem, const std::filesystem::path& state, CoordinatorSettings settings = {});
  Build(const Build&) = delete;
  Build& operator=(const Build&) = delete;

  const Problem& problem() const { return problem_; }
  Coordinator& coordinator() { return coordinator_; }
  const StateDirectory& directory() const { return directory_; }
  /// Writes the dataset of a complete build; returns its tables.
  std::vector<SpaceTable> seal(const std::filesystem::path& file);

 private:
  const Problem problem_;
  const std::string problem_bytes_;
  StateDirectory directory_;
  JobStore store_;
  Journal journal_;
  Coordinator coordinator_;
};

/// What `build` and `serve` are asked for alike.
struct BuildOrder {
  std::string scene;   ///< a TOML file
  std::string out;     ///< the dataset; empty: NAME.h5 in the current directory
  std::string state;   ///< the state directory; empty: OUT.state
  bool force = false;  ///< replace `out` when it holds something else
};

/// Declares SCENE, -o, --state and --force on `app`, which must not outlive `order`.
void addOptions(CLI::App& app, BuildOrder& order);

/// From the scene to the sealed dataset, which is what stdout then tells; nothing to do when `out`
/// is that already. `compute` brings the build that a server at `endpoint` works for to its end,
/// unless it is stopped: then it returns the exit code. Error before anything is computed when the
/// scene is wrong, `out` holds something else, or its folder is not there.
ExitCode carryOut(const BuildOrder& order, const std::string& endpoint,
                  const std::function<ExitCode(Server&, Coordinator&)>& compute);

/// Answers messages and shows progress until the build is complete or stopped, by a message or a
/// signal. `each_turn` is called a few times a second at least.
void serveUntilDone(Server& server, Coordinator& coordinator,
                    const std::function<void()>& each_turn = {});

/// Long enough to rest, short enough for the signals of a terminal.
inline constexpr std::chrono::milliseconds longest_turn{50};

/// done, or partly_failed when a point failed that was tried. Unreachable ones lie beyond max_force
/// by design, or behind points that did fail. Probes do not count.
ExitCode exitCodeOf(const std::vector<SpaceTable>& spaces);

}  // namespace palpate
