#pragma once

#include <Eigen/Core>
#include <functional>
#include <istream>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace palpate {

/// The option `--displacement X Y Z` (metres), or `--displacement -` to read one "X Y Z" per line
/// from standard input, as `solve` and `query` take it. Negative numbers are numbers here, not
/// options.
CLI::Option* addDisplacementOption(CLI::App& app, std::vector<std::string>& words);

/// The option `--at X Y Z` (metres), or `--at -`, with `--displacement -`, to read six numbers per
/// line.
CLI::Option* addPlaceOption(CLI::App& app, std::vector<std::string>& words);

/// Where a finger is and how far it is displaced, metres.
struct TouchInput {
  std::optional<Eigen::Vector3d> at;  ///< nothing: where the active node is
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
};

/// Calls `visit` for the displacement in `words`, or for every line of `input`, where blanks or
/// commas stand between the numbers; empty lines and lines that start with # are passed over. Error
/// (bad input) for what is not three finite numbers, naming the line. `at` has the words of the
/// place, none when none was given; "-" when each line begins with a place, X Y Z, for which
/// `words` must be "-" too. The first displacement that
/// looksLikeMillimetres in a workspace of this radius (m) is warned of on stderr.
void forEachTouch(const std::vector<std::string>& at, const std::vector<std::string>& words,
                  std::istream& input, double workspace_radius,
                  const std::function<void(const TouchInput&)>& visit);

/// Whether a displacement is far beyond a workspace of this radius (both in metres), and a
/// thousandth of it is within.
bool looksLikeMillimetres(const Eigen::Vector3d& displacement, double workspace_radius);

}  // namespace palpate
