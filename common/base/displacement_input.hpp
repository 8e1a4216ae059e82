#pragma once

#include <Eigen/Core>
#include <functional>
#include <istream>
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

/// Calls `visit` for the displacement in `words`, or for every line of `input`, where blanks or
/// commas stand between the numbers; empty lines and lines that start with # are passed over. Error
/// (bad input) for what is not three finite numbers, naming the line. The first displacement that
/// looksLikeMillimetres in a workspace of this radius (m) is warned of on stderr.
void forEachDisplacement(const std::vector<std::string>& words, std::istream& input,
                         double workspace_radius,
                         const std::function<void(const Eigen::Vector3d&)>& visit);

/// Whether a displacement is far beyond a workspace of this radius (both in metres), and a
/// thousandth of it is within.
bool looksLikeMillimetres(const Eigen::Vector3d& displacement, double workspace_radius);

}  // namespace palpate
