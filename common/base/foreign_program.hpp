#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace palpate {

/// An external program that is run to its end, such as sbatch or gmsh.
struct ForeignProgram {
  std::vector<std::string> words;  ///< the program, found in $PATH, then its arguments; no shell
  std::string package;             ///< Debian package that the error names if it is missing
  std::string input = {};          ///< contents of its stdin
  std::chrono::seconds patience = std::chrono::seconds(60);  ///< it is killed after this time
  /// Whether an interrupt of this process (interrupted()) kills it and ends the call with exit code
  /// 130. Otherwise the call waits for its end.
  bool heeds_interrupts = false;
};

/// Its exit code and output.
struct Ran {
  int exit_code = -1;
  std::string out, err;  ///< text on its stdout and stderr
};

/// Runs the program in its own process group, beyond signals of the terminal, and waits for its
/// end. The system kills it if this process dies. Error (bad input) with the package if it is not
/// installed. Error if it cannot be started, is ended by a signal, or takes longer than `patience`.
Ran runToItsEnd(const ForeignProgram& program);

/// Returns whether the program exists in $PATH or at this path.
bool isInstalled(const std::string& program);

}  // namespace palpate
