#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace palpate {

/// An external program to run, such as sbatch or gmsh.
struct ForeignProgram {
  std::vector<std::string> words;  ///< the program (searched in $PATH), then its arguments
  std::string package;     ///< Debian package that the error names if the program is missing
  std::string input = {};  ///< contents of its stdin
  /// The program is killed after this time.
  std::chrono::seconds patience = std::chrono::seconds(60);
  /// Whether an interrupt of this process (interrupted()) ends the program and makes runToItsEnd()
  /// throw an Error with exit code 130. Otherwise the call waits until the program ends.
  bool heeds_interrupts = false;
};

/// Exit code and output of a program that has ended.
struct Ran {
  int exit_code = -1;
  std::string out, err;  ///< text on its stdout and stderr
};

/// Runs the program in its own process group, which signals of the terminal do not reach, and waits
/// until it ends. The system kills the program if this process dies. Error (bad input) that names
/// the package if the program is not installed. Error if the program cannot be started, is ended by
/// a signal, or takes longer than `patience`.
Ran runToItsEnd(const ForeignProgram& program);

/// Returns the path of a program, which is searched in $PATH unless its name has a slash; empty if
/// there is no such executable.
std::string installedPath(const std::string& program);
inline bool isInstalled(const std::string& program) { return !installedPath(program).empty(); }

}  // namespace palpate
