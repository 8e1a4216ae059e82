#pragma once

#include <iosfwd>

#include "common/base/program.hpp"

namespace palpate {

struct ExportOptions {
  std::filesystem::path dataset;
  /// Its ending says the format: .vtu for one configuration, .pvd or .csv for a way.
  std::filesystem::path output;
  /// An active node or the area of a finger; may be empty when the dataset has one only.
  std::string active = {};
  /// Three numbers, metres; "-": one per line of the input (ways alone); or none, with a point.
  std::vector<std::string> displacement = {};
  /// Three numbers, metres; "-": from the input, before each displacement; none: no place.
  std::vector<std::string> at = {};
  std::vector<double> point = {};  ///< three coordinates in spacings, or none
  int steps = 0;                   ///< of a straight way from rest; 0: not given
  std::string method = {};         ///< of interpolation; empty: the first of forceFieldMethods()
  bool replace = false;            ///< replace what is there
};

/// `palpate export`: writes configurations of a dataset for ParaView and others, or the forces
/// along a way (docs/export.md), and tells what it wrote. Each file is whole or not there; of a
/// series the list, OUTPUT, comes last. ExitCode::partly_failed when some displacement was outside
/// of the covered region (it is written all the same, and marked), interrupted when a signal ended
/// a series. Error (bad input) for an unknown ending, a wrong dataset, name, method or number, a
/// point that was not solved, and for what is there already, without `replace`; Error when a file
/// cannot be written.
ExitCode exportConfigurations(const ExportOptions& options, std::istream& input,
                              std::ostream& output);

/// The verb `export` of palpate-answers, on standard input and output.
Verb exportVerb();

}  // namespace palpate
