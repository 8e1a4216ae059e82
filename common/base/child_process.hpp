#pragma once

#include <signal.h>
#include <sys/types.h>

#include <array>
#include <string>
#include <vector>

namespace palpate {

/// How a child is started.
struct ChildSettings {
  const char* program = nullptr;  ///< program to run instead of the first word
  /// stdin, stdout and stderr of the child: descriptors above 2, or the standard ones of this
  /// process.
  std::array<int, 3> files = {0, 1, 2};
  int death_signal = SIGKILL;  ///< signal that the child gets if the calling thread ends
  int error_pipe = -1;         ///< descriptor above 2 that gets errno if exec fails; -1: none
};

/// Starts a program in a process group of its own, which Ctrl-C does not reach. `words` holds the
/// program, searched in $PATH unless its name has a slash, then its arguments. A child that cannot
/// be executed ends with exit code 127. Error if no process can be started. The caller must wait
/// for the child (waitpid).
pid_t startChild(std::vector<std::string> words, const ChildSettings& settings = {});

/// Returns the words of the command line by which this program was started.
std::vector<std::string> commandLine();

/// Waits until the child ends. Returns its status in the form of waitpid.
int waitFor(pid_t child);

}  // namespace palpate
