#pragma once

#include <iosfwd>

#include "common/base/program.hpp"

namespace palpate {

struct ExportOptions {
  std::filesystem::path dataset;
  /// The extension selects the format: .vtu for one configuration, .pvd or .csv for a path.
  std::filesystem::path output;
  /// An active node or the area of a finger; may be empty if the dataset has only one.
  std::string active = {};
  /// Three numbers, metres; "-" to read one per line of the input (paths only); or empty, with a
  /// point.
  std::vector<std::string> displacement = {};
  /// Three numbers, metres; "-" to read them before each displacement; empty: no place.
  std::vector<std::string> at = {};
  std::vector<double> point = {};  ///< three coordinates in spacings, or empty
  int steps = 0;                   ///< of a straight path from rest; 0: not given
  std::string method = {};  ///< interpolation method; empty: the first of forceFieldMethods()
  bool replace = false;     ///< replace existing files
};

/// Runs `palpate export`: writes configurations of a dataset for ParaView and other programs, or
/// the forces along a path (docs/export.md), and prints a summary. No file is left incomplete; the
/// list of a series, OUTPUT, is written last.
///
/// Returns ExitCode::partly_failed if a displacement was outside the covered region (it is written
/// too, and marked), and ExitCode::interrupted if a signal ended a series. Error (bad input) for an
/// unknown extension, a wrong dataset, name, method or number, an unsolved point, and for existing
/// files without `replace`. Error if a file cannot be written.
ExitCode exportConfigurations(const ExportOptions& options, std::istream& input,
                              std::ostream& output);

/// The command `export` of palpate-answers, on standard input and output.
Verb exportVerb();

}  // namespace palpate
