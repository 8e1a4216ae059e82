#pragma once

#include <functional>
#include <memory>

#include "common/base/program.hpp"
#include "scheduler/builds/build.hpp"

namespace palpate {

/// What `build` and `serve` are asked for alike.
struct BuildOrder {
  std::string scene;                     ///< a TOML file
  std::string out;                       ///< the dataset; empty: NAME.h5 in the current directory
  std::string state;                     ///< the state directory; empty: OUT.state
  bool replace = false;                  ///< replace `out` when it holds something else
  std::optional<unsigned> hung_after_s;  ///< of a solve; nothing: from what solves took so far
  double spot_checks_percent = 0;        ///< of all results, solved again by other machines
  std::string kernels;  ///< name of a CpuFamily; empty: those of the first result decide

  /// Declares SCENE, -o, --state, --replace, --hung-after and --kernels on `app`, which must not
  /// outlive this.
  void addTo(CLI::App& app);
};

/// Who works for a build, from when its server listens until it does no more.
class Crew {
 public:
  Crew() = default;
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;
  virtual ~Crew() = default;

  /// In every turn, a few times a second at least.
  virtual void look() = 0;
  /// The build is complete, stuck, stopped or to begin anew, and no turn is made for a while.
  virtual void pause(Next) {}
  /// Whether somebody has not left yet; asked in every turn.
  virtual bool isThere() = 0;
  /// Nobody waits for those who have not left.
  virtual void end() {}
};

/// How `build` and `serve` differ.
struct Serving {
  std::string endpoint;           ///< where to listen
  bool own_keys = false;          ///< those of the state directory, which the server's workers get
  std::optional<KeyFolder> keys;  ///< else; nothing: for everybody
  std::function<std::unique_ptr<Crew>(Server&, Build&)> crew;
  std::chrono::seconds drain_limit{30};           ///< workers may take so long to finish and leave
  std::function<void()> anew = [] {};             ///< what is recorded is read once more
  ExitCode when_stopped = ExitCode::interrupted;  ///< by palpate stop
};

/// From the scene to the sealed dataset, which is what stdout then tells; nothing to do when the
/// file is that already. Begins anew when a record is damaged, a worker is found to lie, or
/// failures are to be tried again. Error before anything is computed when the scene is wrong, the
/// file holds something else, or its folder is not there.
ExitCode serveBuild(const BuildOrder& order, Serving serving);

}  // namespace palpate
