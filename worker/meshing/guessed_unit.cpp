#include "worker/meshing/guessed_unit.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/base/text.hpp"
#include "common/problem/problem.hpp"

namespace palpate {
namespace {

/// The largest extents that are taken for metres and for centimetres.
constexpr double most_metres = 1, most_centimetres = 40;
/// The guess is certain from sure_metres to most_metres (metres), and from sure_millimetres to
/// most_millimetres (millimetres).
constexpr double sure_metres = 0.01, sure_millimetres = 100, most_millimetres = 1000;

std::string sizeIn(double extent, const LengthUnit& unit) {
  return fmt::format("{:.3g} cm wide in {}", 100 * extent * unit.metres, unit.name);
}

}  // namespace

std::optional<GuessedUnit> guessedUnit(double extent) {
  const auto& [m, cm, mm] = length_units;
  if (!(extent >= smallest_body) || extent * mm.metres > largest_body) return std::nullopt;
  if (extent <= most_metres) {
    const bool sure = extent >= sure_metres;
    return GuessedUnit{m, sure ? "" : sizeIn(extent, m) + ", which is small"};
  }
  if (extent < most_centimetres) {
    const std::string others = sizeIn(extent, mm);
    return GuessedUnit{
        cm, fmt::format("{}, and {}", sizeIn(extent, cm),
                        extent > largest_body ? others : others + ", or " + sizeIn(extent, m))};
  }
  if (extent < sure_millimetres)
    return GuessedUnit{mm, fmt::format("{}, and {}", sizeIn(extent, mm), sizeIn(extent, cm))};
  const bool sure = extent <= most_millimetres;
  return GuessedUnit{mm, sure ? "" : sizeIn(extent, mm) + ", which is large"};
}

std::string whyNoUnit(double extent) {
  return fmt::format(
      "the body is {:.4g} wide, and no unit (m, cm, mm) gives it a width of {:g} to {:g} m", extent,
      smallest_body, largest_body);
}

bool makesABody(double extent, const LengthUnit& unit) {
  return extent * unit.metres >= smallest_body && extent * unit.metres <= largest_body;
}

std::string whyNotIn(double extent, const LengthUnit& unit) {
  return fmt::format("the body is {:.4g} wide, which in {} is not {:g} to {:g} m", extent,
                     unit.name, smallest_body, largest_body);
}

LengthUnit unitNamed(const std::string& word) {
  const auto* const found = std::ranges::find(length_units, word, &LengthUnit::word);
  if (found != length_units.end()) return *found;
  throw badInput("--unit {}: write {}", word, listed(mapped(length_units, &LengthUnit::word)));
}

}  // namespace palpate
