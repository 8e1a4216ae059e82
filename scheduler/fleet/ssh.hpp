#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/base/child_process.hpp"
#include "scheduler/fleet/launches.hpp"

namespace palpate {

/// Options of workers on machines that ssh reaches.
struct SshOptions {
  std::vector<std::string> command;  ///< command for one machine's workers, in shell syntax
  std::vector<std::string> more;     ///< further options of ssh, unchanged
};

/// Runs workers on a set of workstations through one `ssh HOST` each. Retries failed connections
/// with growing pauses. When a connection ends, its remote workers deliver their results and end
/// too. One thread.
class SshHosts {
 public:
  using Time = Backoff::Time;

  /// Each of `hosts` is a name for ssh, "node1" or "me@node1", and gets one worker per core;
  /// "node1:4" gets four workers. All must have passed checkHost().
  SshHosts(const SshOptions& options, const std::vector<std::string>& hosts);

  /// Starts connections that are due, and logs ended connections. Call a few times a second.
  void keep(Time now);
  /// Returns the number of open connections.
  std::size_t running() const;
  /// Returns true if the workers of every host have ended because no work is left.
  bool done() const;
  /// Ends all connections. Workers have `grace` to deliver their results.
  void terminate(std::chrono::milliseconds grace);

  /// Throws Error (bad input) if the syntax of `host` is invalid.
  static void checkHost(const std::string& host);
  /// Returns the command line for a host, as text for users.
  static std::string told(const SshOptions& options, const std::string& host);

 private:
  struct Host {
    std::string name;
    std::vector<std::string> command;
    std::unique_ptr<ChildProcess> connection = nullptr;  ///< null: none
    Time begun = {};
    Backoff retry{std::chrono::seconds(5)};
    bool done = false;
  };
  std::vector<Host> hosts_;
};

}  // namespace palpate
