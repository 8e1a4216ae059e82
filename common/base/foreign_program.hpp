#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace palpate {

/// A program of others that is run to its end: sbatch, gmsh, ...
struct ForeignProgram {
  std::vector<std::string> words;  ///< the first is the program, looked for in $PATH; no shell
  std::string package;             ///< of Debian, named where the program is missing
  std::string input = {};          ///< at its stdin
  std::chrono::seconds patience = std::chrono::seconds(60);  ///< then it is killed
  /// Kill it when this process is interrupted (interrupted()), and end with exit code 130. Else
  /// whoever waits for it finishes first.
  bool heeds_interrupts = false;
};

/// What became of it.
struct Ran {
  int exit_code = -1;
  std::string out, err;  ///< what it wrote to stdout and stderr
};

/// Runs it, in a group of processes of its own, which signals of a terminal do not reach, and waits
/// for its end; the system kills it when this process dies. Error (bad input)
/// that names the package when it is not installed; Error when it cannot be started, a signal ends
/// it, or it takes longer than `patience`.
Ran runToItsEnd(const ForeignProgram& program);

/// Whether there is such a program in $PATH, or at this path.
bool isInstalled(const std::string& program);

}  // namespace palpate
