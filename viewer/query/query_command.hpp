#pragma once

#include <iosfwd>

#include "common/base/program.hpp"

namespace palpate {

struct QueryOptions {
  std::filesystem::path dataset;
  /// An active node or the area of a finger; may be empty if the dataset has only one.
  std::string active;
  /// Three numbers, metres; or "-" to read one displacement per line of the input.
  std::vector<std::string> displacement;
  std::string method = "potential";
  bool json = false;
  /// Three numbers, metres; "-" to read them before each displacement; empty: no place.
  std::vector<std::string> at = {};
};

/// Runs `palpate query`: prints the interpolated force at each displacement, as one JSON object per
/// line or as a readable paragraph. Returns ExitCode::partly_failed if a displacement was outside
/// the covered region; its answer is printed too, and marked. Error (bad input) for a wrong
/// dataset, name, method or number; errors in the input name the line.
ExitCode query(const QueryOptions& options, std::istream& input, std::ostream& output);

/// The command `query` of palpate-answers, on standard input and output.
Verb queryVerb();

}  // namespace palpate
