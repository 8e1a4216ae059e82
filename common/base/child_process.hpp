#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace palpate {

/// Starts a program in a process group of its own, which Ctrl-C does not reach. The system kills
/// the child if the calling thread ends. `words` holds the path of the program, then its arguments.
/// A child that cannot be executed ends with exit code 127. Error if no process can be started. The
/// caller must wait for the child (waitpid).
pid_t startChild(std::vector<std::string> words);

}  // namespace palpate
