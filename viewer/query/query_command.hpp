#pragma once

#include <iosfwd>

#include "common/base/program.hpp"

namespace palpate {

struct QueryOptions {
  std::filesystem::path dataset;
  /// An active node or the area of a finger; may be empty when the dataset has one only.
  std::string active;
  /// Three numbers, metres; or "-": one displacement per line of the input.
  std::vector<std::string> displacement;
  std::string method = "potential";
  bool json = false;
  /// Three numbers, metres; "-": from the input, before each displacement; none: no place.
  std::vector<std::string> at = {};
};

/// `palpate query`: answers with the interpolated force at each displacement, one JSON object per
/// line or a paragraph for a person. ExitCode::partly_failed when some displacement was outside of
/// the covered region (it is answered all the same, and marked). Error (bad input) for a wrong
/// dataset, name, method or number; for a line of the input it names the line.
ExitCode query(const QueryOptions& options, std::istream& input, std::ostream& output);

/// The verb `query` of palpate-answers, on standard input and output.
Verb queryVerb();

}  // namespace palpate
