#pragma once

#include <deque>
#include <string>
#include <vector>

#include "scheduler/fleet/launches.hpp"
#include "scheduler/fleet/worker_pool.hpp"

namespace palpate {

/// How workers are started on machines that ssh reaches.
struct SshOptions {
  std::vector<std::string> command;  ///< the workers of one machine, as its shell reads the words
  std::vector<std::string> more;     ///< options of ssh, as they are
};

/// Workers on a room of workstations: one `ssh HOST` each, which is begun anew, later and later, as
/// long as it fails. What runs there ends with the connection, within its time for that. One
/// thread.
class SshHosts {
 public:
  using Time = Backoff::Time;

  /// `hosts` as ssh takes them, "node1" or "me@node1", or "node1:4" for four workers instead of one
  /// a core: all passed checkHost().
  SshHosts(const SshOptions& options, const std::vector<std::string>& hosts);

  /// Begins what is due, and tells (log) what ended. Call a few times a second.
  void keep(Time now);
  /// Connections that are there.
  std::size_t running() const;
  /// Every host had workers that came to their end, because there is no more work.
  bool done() const;
  /// Ends all connections. Workers have `grace` to deliver what they hold.
  void terminate(std::chrono::milliseconds grace);

  /// Error (bad input) when it is no host.
  static void checkHost(const std::string& host);
  /// What is run for a host, for people.
  static std::string told(const SshOptions& options, const std::string& host);

 private:
  struct Host {
    Host(std::string of, std::vector<std::string> command)
        : name(std::move(of)), connection(std::move(command)) {}
    std::string name;
    WorkerPool connection;
    Time begun;
    Backoff retry{std::chrono::seconds(5)};
    bool done = false;
  };
  std::deque<Host> hosts_;  // a pool cannot be moved
};

}  // namespace palpate
