#pragma once

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <string>

#include "tests/support/command.hpp"

namespace palpate::test {

/// Networks for this test only: no other program takes their ports, and nothing remains of them,
/// however the test ends. If they cannot be created (only root can), the test uses the existing
/// network.
///
/// Programs belong to the network in which this process is when it starts them.
class OwnNetwork {
 public:
  OwnNetwork() : before_(current()) {
    if (unshare(CLONE_NEWNET) != 0 || runCommand("ip link set lo up").exit_code != 0) return;
    here_ = current();
  }
  ~OwnNetwork() {
    if (before_ >= 0) setns(before_, CLONE_NEWNET);
    for (const int network : {before_, here_, there_})
      if (network >= 0) close(network);
  }
  OwnNetwork(const OwnNetwork&) = delete;
  OwnNetwork& operator=(const OwnNetwork&) = delete;

  /// A second network, connected to the first by one cable: 10.77.0.1 here, 10.77.0.2 there. False
  /// if it cannot be created.
  bool joinAnother() {
    if (here_ < 0 || unshare(CLONE_NEWNET) != 0) return false;
    there_ = current();
    const std::string here = "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(here_);
    bool joined = run("ip link set lo up && ip link add there type veth peer name here netns " +
                      here + " && ip addr add 10.77.0.2/24 dev there && ip link set there up");
    goHere();
    return joined && run("ip addr add 10.77.0.1/24 dev here && ip link set here up");
  }
  void goHere() const { setns(here_, CLONE_NEWNET); }
  void goThere() const { setns(there_, CLONE_NEWNET); }

 private:
  static int current() { return open("/proc/self/ns/net", O_RDONLY | O_CLOEXEC); }
  static bool run(const std::string& commands) { return runCommand(commands).exit_code == 0; }
  int before_, here_ = -1, there_ = -1;
};

}  // namespace palpate::test
