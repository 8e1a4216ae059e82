#include "common/base/displacement_input.hpp"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/number_in.hpp"
#include "common/base/number_text.hpp"

namespace palpate {
namespace {

/// Returns the numbers in `words`. Error unless there are `count` (3 or 6), all of them finite.
std::vector<double> numbersIn(const std::vector<std::string>& words, std::size_t count,
                              const std::string& where) {
  if (words.size() != count)
    throw badInput("{}: expected {}, found {}", where,
                   count == 3 ? "three numbers X Y Z (m)"
                              : "six numbers (m), X Y Z of the place and X Y Z of the displacement",
                   words.size());
  std::vector<double> numbers;
  for (const std::string& word : words) {
    // Skip a leading plus sign, which users may write but numberIn refuses.
    const auto number = numberIn<double>(std::string_view(word).substr(word.starts_with('+')));
    if (!number || !std::isfinite(*number))
      throw badInput("{}: \"{}\" is not a finite number", where, word);
    numbers.push_back(*number);
  }
  return numbers;
}

Eigen::Vector3d vectorIn(const std::vector<std::string>& words, const std::string& where) {
  return Eigen::Vector3d(numbersIn(words, 3, where).data());
}

/// Displacements longer than this number of workspace radii are probably a mistake.
constexpr double far_beyond = 3;

std::vector<std::string> wordsIn(std::string line) {
  std::ranges::replace(line, ',', ' ');
  std::istringstream words(line);
  return {std::istream_iterator<std::string>(words), {}};
}

/// Adds an option whose value is three numbers or a single -.
CLI::Option* addTriple(CLI::App& app, const char* name, std::vector<std::string>& words,
                       const char* help) {
  CLI::Option* const option = app.add_option(name, words, help)->expected(1, 3);
  return option->allow_extra_args(false)->type_name("X Y Z");
}

}  // namespace

CLI::Option* addPlaceOption(CLI::App& app, std::vector<std::string>& words) {
  return addTriple(
      app, "--at", words,
      "Place of a finger, m (the nearest surface point is used); or - to read the six numbers "
      "X Y Z of place and displacement from each line");
}

CLI::Option* addDisplacementOption(CLI::App& app, std::vector<std::string>& words) {
  CLI::Option* const option = addTriple(
      app, "--displacement", words,
      "Displacement of the active node, metres; or - to read one per line from standard input");
  return option->required();
}

void forEachTouch(const std::vector<std::string>& at, const std::vector<std::string>& words,
                  std::istream& input, double workspace_radius,
                  const std::function<void(const TouchInput&)>& visit) {
  const bool places_from_input = at == from_input;
  if (places_from_input && words != from_input)
    throw badInput("--at - needs --displacement -, because each input line has six numbers");
  std::optional<Eigen::Vector3d> place;
  if (!at.empty() && !places_from_input) place = vectorIn(at, "--at");
  bool warned = false;
  const auto answer = [&](const Eigen::Vector3d& p) {
    if (!warned && looksLikeMillimetres(p, workspace_radius)) {
      spdlog::warn(
          "displacement ({}) m is far outside the workspace of radius {:.4g} m; if these are "
          "millimetres, write ({})",
          vectorText(p, 6), workspace_radius, vectorText(1e-3 * p, 6));
      warned = true;
    }
    visit({place, p});
  };
  if (words != from_input) return answer(vectorIn(words, "--displacement"));
  std::string line;
  for (int number = 1; std::getline(input, line); ++number) {
    const std::vector<std::string> in_line = wordsIn(line);
    if (in_line.empty() || in_line.front().starts_with('#')) continue;
    const std::string where = fmt::format("standard input, line {}", number);
    const std::vector<double> numbers = numbersIn(in_line, places_from_input ? 6 : 3, where);
    if (places_from_input) place = Eigen::Vector3d(numbers.data());
    answer(Eigen::Vector3d(numbers.data() + numbers.size() - 3));
  }
  if (input.bad()) throw failure("standard input could not be read");
}

bool looksLikeMillimetres(const Eigen::Vector3d& displacement, double workspace_radius) {
  PALPATE_ASSERT(workspace_radius > 0, "the workspace must have a positive radius");
  const double length = displacement.stableNorm();
  return length > far_beyond * workspace_radius && 1e-3 * length <= workspace_radius;
}

}  // namespace palpate
