#pragma once

#include <functional>
#include <string>

#include "common/base/program.hpp"
#include "scheduler/build.hpp"
#include "scheduler/service/server.hpp"

namespace palpate {

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
/// is that already. `compute` brings a build to its end, unless it is stopped: then it returns the
/// exit code. Error before anything is computed when the scene is wrong, `out` holds something
/// else, or its folder is not there.
ExitCode carryOut(const BuildOrder& order, const std::function<ExitCode(Build&)>& compute);

/// Answers messages and shows progress until the build is complete or stopped, by a message or a
/// signal. `each_turn` is called a few times a second at least.
void serveUntilDone(Server& server, Coordinator& coordinator,
                    const std::function<void()>& each_turn = {});

/// Long enough to rest, short enough for the signals of a terminal.
inline constexpr std::chrono::milliseconds longest_turn{50};

}  // namespace palpate
