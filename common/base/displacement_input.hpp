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

/// Adds the option --displacement of `solve` and `query`. Its value is X Y Z (metres), or - to read
/// one "X Y Z" per line from standard input. Negative numbers such as -0.5 are read as numbers, not
/// as options.
CLI::Option* addDisplacementOption(CLI::App& app, std::vector<std::string>& words);

/// Adds the option --at. Its value is X Y Z (metres), or -, which requires `--displacement -`; then
/// each line has six numbers.
CLI::Option* addPlaceOption(CLI::App& app, std::vector<std::string>& words);

/// Value of either option that stands for standard input.
inline const std::vector<std::string> from_input = {"-"};

/// Place of a finger on the surface and displacement there, metres.
struct TouchInput {
  std::optional<Eigen::Vector3d> at;  ///< nullopt for the place of the active node
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
};

/// Calls `visit` once with the displacement in `words`, or for every line of `input` if `words` is
/// "-". Numbers in a line are separated by blanks or commas. Empty lines and lines that start with
/// # are skipped. Error (bad input) that names the line if it holds anything but finite numbers.
///
/// `at` holds the words after --at; it is empty without that option. If `at` is "-", `words` must
/// be "-" too, and each line begins with the X Y Z of a place. Logs a warning about the first
/// displacement for which looksLikeMillimetres() is true, with `workspace_radius` in metres.
void forEachTouch(const std::vector<std::string>& at, const std::vector<std::string>& words,
                  std::istream& input, double workspace_radius,
                  const std::function<void(const TouchInput&)>& visit);

/// Returns whether a displacement was probably given in millimetres: it is far outside a workspace
/// of this radius (both in metres), but a thousandth of it is inside.
bool looksLikeMillimetres(const Eigen::Vector3d& displacement, double workspace_radius);

}  // namespace palpate
