#include "common/base/child_process.hpp"

#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"

namespace palpate {
namespace {

/// Runs in the child between vfork and exec, so it makes only async-signal-safe calls, and changes
/// no memory but its own variables.
[[noreturn]] void become(pid_t parent, char* const* arguments) {
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent) _exit(126);
  // A process group of its own keeps Ctrl-C from the child: its parent handles Ctrl-C.
  setpgid(0, 0);
  execv(arguments[0], arguments);
  _exit(127);
}

}  // namespace

pid_t startChild(std::vector<std::string> words) {
  PALPATE_ASSERT(!words.empty(), "a command must begin with its program");
  // Allocate now, because the child must not allocate between vfork and exec.
  std::vector<char*> arguments;
  for (std::string& argument : words) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  // fork() would write-protect all memory of this process. In a client, the ticks would then wait
  // for milliseconds.
  const pid_t child = vfork();  // NOLINT(clang-analyzer-security.insecureAPI.vfork)
  if (child < 0) throw failure("cannot start {}: {}", words.front(), errnoText());
  // Linux allows async-signal-safe calls here. NOLINTNEXTLINE(clang-analyzer-unix.Vfork)
  if (child == 0) become(parent, arguments.data());
  return child;
}

}  // namespace palpate
