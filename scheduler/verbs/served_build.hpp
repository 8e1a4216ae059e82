#pragma once

#include <functional>
#include <memory>

#include "common/base/program.hpp"
#include "scheduler/builds/build.hpp"

namespace palpate {

/// Command-line options that `build` and `serve` share.
struct BuildOrder {
  std::string scene;     ///< TOML file
  std::string out;       ///< dataset; by default NAME.h5 in the current directory
  std::string state;     ///< state directory; by default OUT.state
  bool replace = false;  ///< replace `out` if it holds something else
  /// time limit of a solve, s; if unset, it is derived from earlier solves
  std::optional<unsigned> hung_after_s;
  double spot_checks_percent = 0;  ///< percent of the results that another machine solves again
  std::string kernels;             ///< name of a CpuFamily; by default that of the first result

  /// Declares SCENE, -o, --state, --replace, --hung-after and --kernels on `app`, which must not
  /// outlive this object.
  void addTo(CLI::App& app);
};

/// The workers of a build, from the time when its server listens until the server stops.
class Crew {
 public:
  virtual ~Crew() = default;

  /// Called in every turn, at least a few times a second.
  virtual void look() = 0;
  /// Called before a long time without turns, because the build is complete, stuck, stopped or must
  /// restart.
  virtual void pause(Next) {}
  /// Returns true while some worker has not left; called in every turn of the shutdown.
  virtual bool isThere() = 0;
  /// Ends the remaining workers. Their results are no longer needed.
  virtual void end() {}
};

/// Settings in which `build` and `serve` differ.
struct Serving {
  std::string endpoint;   ///< address to listen on
  bool own_keys = false;  ///< use the keys in the state directory, which the local workers use too
  std::optional<KeyFolder> keys = {};  ///< keys to use otherwise; if unset, peers need none
  std::function<std::unique_ptr<Crew>(Server&, Build&)> crew;
  std::chrono::seconds drain_limit{30};           ///< time for workers to finish and leave
  std::function<void()> anew = [] {};             ///< called before the records are read again
  ExitCode when_stopped = ExitCode::interrupted;  ///< exit code after palpate stop
};

/// Runs a build from the scene to the sealed dataset, and prints the summary to stdout. Does
/// nothing if the file already is that dataset. Restarts from the recorded results when a record is
/// damaged, a worker's result is found wrong, or failures are to be tried again. Before computing
/// anything, throws Error if the scene is invalid, the file holds something else, or its directory
/// is missing.
ExitCode serveBuild(const BuildOrder& order, Serving serving);

}  // namespace palpate
