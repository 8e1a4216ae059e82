#pragma once

#include <iosfwd>

#include "common/base/program.hpp"

namespace palpate {

struct QueryOptions {
  std::filesystem::path dataset;
  /// Name of an active node or of a finger's area; may be empty if the dataset has only one.
  std::string active;
  /// Three numbers, metres; or "-" to read one displacement from each line of the input.
  std::vector<std::string> displacement;
  std::string method = "potential";
  bool json = false;
  /// Place of the finger: three numbers, metres; "-" to read the place before each displacement;
  /// empty if there is none.
  std::vector<std::string> at = {};

  void addTo(CLI::App& app);  ///< declares the options of the verb
};

/// Runs `palpate query`: prints the interpolated force at each displacement, as one JSON object per
/// line or as a readable paragraph. Returns ExitCode::partly_failed if an answer was not reliable
/// (ForceSample::inside); such an answer is printed too, and marked. Error (bad input) for a wrong
/// dataset, name, method or number; errors in the input name the line.
ExitCode query(const QueryOptions& options, std::istream& input, std::ostream& output);

/// The command `query` of palpate-answers, on standard input and output.
extern const Verb query_verb;

}  // namespace palpate
