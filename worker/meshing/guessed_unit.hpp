#pragma once

#include <optional>
#include <string>

#include "common/base/units.hpp"

namespace palpate {

/// What a mesh file is probably written in: files do not say.
struct GuessedUnit {
  LengthUnit unit;
  /// Another unit is possible too: what it would make of the body, a clause for people. Empty where
  /// the size speaks for itself.
  std::string doubt = {};
};

/// By the largest extent of the body in the unit of the file: up to 1 metres, below 40 centimetres,
/// then millimetres; an organ is 4 cm to 1 m wide. Nothing where no unit makes it a body of 1 mm
/// to 10 m.
std::optional<GuessedUnit> guessedUnit(double extent);

/// Why there is none for a body of this extent: a clause for people.
std::string whyNoUnit(double extent);

/// Whether a body of this extent in the unit of its file is one of 1 mm to 10 m.
bool makesABody(double extent, const LengthUnit& unit);

/// What is wrong with a unit that makes none: a clause for people.
std::string whyNotIn(double extent, const LengthUnit& unit);

/// The unit of this word; Error (bad input) that lists the words otherwise.
LengthUnit unitNamed(const std::string& word);

}  // namespace palpate
