#pragma once

#include <optional>
#include <string>

#include "common/base/units.hpp"

namespace palpate {

/// The likely length unit of a mesh. Mesh files do not state their unit.
struct GuessedUnit {
  LengthUnit unit;
  /// Why another unit is possible, as a clause for the user: the sizes of the body in the possible
  /// units. Empty if the guess is clear.
  std::string doubt = {};
};

/// Guesses the unit from the body's largest extent in the unit of the file: metres up to 1,
/// centimetres below 40, otherwise millimetres. An organ is 4 cm to 1 m wide. Returns nullopt if no
/// unit gives a body of 1 mm to 10 m.
std::optional<GuessedUnit> guessedUnit(double extent);

/// Returns why no unit fits a body of this extent: a clause for the user.
std::string whyNoUnit(double extent);

/// Returns whether a body of this extent in this unit measures 1 mm to 10 m.
bool makesABody(double extent, const LengthUnit& unit);

/// Returns why this unit does not fit: a clause for the user.
std::string whyNotIn(double extent, const LengthUnit& unit);

/// Returns the unit with this word (LengthUnit::word), such as "mm". Error (bad input), with a list
/// of the words, if there is none.
LengthUnit unitNamed(const std::string& word);

}  // namespace palpate
