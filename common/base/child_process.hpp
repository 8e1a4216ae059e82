#pragma once

#include <signal.h>
#include <sys/types.h>

#include <array>
#include <chrono>
#include <optional>
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

/// A program that runs as a child, started as by startChild(). One thread: the kernel ties the life
/// of a child to the thread that started it.
class ChildProcess {
 public:
  explicit ChildProcess(std::vector<std::string> words, const ChildSettings& settings = {})
      : pid_(startChild(std::move(words), settings)) {}
  ~ChildProcess();  ///< kills the program if it still runs
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t id() const { return pid_; }
  bool running();
  /// Number of the signal that ended the program; 0 if it exited. Call this and the following two
  /// functions only after the end.
  int signal() const;
  int exitCode() const;     ///< 128 + signal() if a signal ended the program
  std::string how() const;  ///< how the program ended: "exit code 1", "signal 9 (Killed)"
  /// Sends a signal, if the program still runs.
  void send(int signal);
  /// Sends SIGTERM, and after `grace` SIGKILL. Returns when the program has ended.
  void terminate(std::chrono::milliseconds grace);

 private:
  pid_t pid_;
  std::optional<int> status_;  ///< as waitpid gives it; none while the program runs
};

/// Returns the words of the command line by which this program was started.
std::vector<std::string> commandLine();

/// Waits until the child ends. Returns its status in the form of waitpid.
int waitFor(pid_t child);

}  // namespace palpate
