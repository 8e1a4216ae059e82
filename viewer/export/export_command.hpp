#pragma once

#include <iosfwd>

#include "common/base/program.hpp"

namespace palpate {

struct ExportOptions {
  std::filesystem::path dataset;
  /// The extension selects the format: .vtu for one configuration, .pvd or .csv for a path.
  std::filesystem::path output;
  /// Name of an active node or of a finger's area; may be empty if the dataset has only one.
  std::string active = {};
  /// Displacement: three numbers, metres; "-" to read one from each line of the input (paths only);
  /// empty if `point` is given.
  std::vector<std::string> displacement = {};
  /// Place of the finger: three numbers, metres; "-" to read the place before each displacement;
  /// empty if there is none.
  std::vector<std::string> at = {};
  std::vector<double> point = {};  ///< lattice point, three coordinates in spacings; or empty
  int steps = 0;                   ///< number of steps of a straight path from rest; 0: not given
  std::string method = {};  ///< interpolation method; empty: the first of forceFieldMethods()
  bool replace = false;     ///< replace existing files

  void addTo(CLI::App& app);  ///< declares the options of the verb
};

/// Runs `palpate export`: writes configurations of a dataset for ParaView and other programs, or
/// the forces along a path (docs/export.md), and prints a summary. No file is left incomplete. In a
/// series, OUTPUT, which lists the other files, is written last.
///
/// Returns ExitCode::partly_failed if an answer was not reliable (ForceSample::inside); such an
/// answer is written too, and marked. Returns ExitCode::interrupted if a signal ended a series.
/// Error (bad input) for an unknown extension, a wrong dataset, name, method or number, an unsolved
/// point, and for existing files without `replace`. Error if a file cannot be written.
ExitCode exportConfigurations(const ExportOptions& options, std::istream& input,
                              std::ostream& output);

/// The command `export` of palpate-answers, on standard input and output.
extern const Verb export_verb;

}  // namespace palpate
