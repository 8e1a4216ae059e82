#pragma once

#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <stdexcept>

/// Copies of this process, for tests that change a whole process.
namespace palpate::test {

/// Runs `action` in a copy of this process. The copy exits normally with the returned code, or with
/// 101 and a message if the action throws.
inline pid_t startChild(const std::function<int()>& action) {
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork");
  if (child > 0) return child;
  try {
    std::exit(action());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    std::exit(101);
  }
}

/// Waits for the end of the process. Returns its exit code, or minus the signal that ended it.
inline int codeOf(pid_t child) {
  int status = 0;
  if (waitpid(child, &status, 0) != child) throw std::runtime_error("waitpid");
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

}  // namespace palpate::test
