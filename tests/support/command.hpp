#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <string>

#include "common/base/error.hpp"

namespace palpate::test {

/// Exit code and output of a command.
struct CommandResult {
  int exit_code = -1;  ///< -1 if a signal ended it
  std::string output;  ///< stdout and stderr, in the order written
};

/// Runs a shell command line and waits for it.
inline CommandResult runCommand(const std::string& line) {
  FILE* pipe = popen((line + " 2>&1").c_str(), "r");
  if (pipe == nullptr) throw failure("cannot run {}", line);
  CommandResult result;
  char buffer[4096];
  while (const std::size_t count = fread(buffer, 1, sizeof buffer, pipe))
    result.output.append(buffer, count);
  const int status = pclose(pipe);
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  return result;
}

}  // namespace palpate::test
