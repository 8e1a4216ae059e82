#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace palpate {

/// Strain energy W of the tissue. Words of the scene file: "linear", "st-venant-kirchhoff",
/// "modified-st-venant-kirchhoff", "mooney-rivlin".
enum class LawName : std::uint8_t {
  linear,
  st_venant_kirchhoff,
  modified_st_venant_kirchhoff,
  mooney_rivlin
};
/// "none", "P1" (equal order, the paper's; violates inf-sup), "P1-stabilized" (polynomial pressure
/// projection).
enum class PressureSpace : std::uint8_t { none, p1, p1_stabilized };
/// "ln-det-F" (default, a barrier: no element can invert) or "det-F-1" (the paper's and GetFEM's).
enum class Constraint : std::uint8_t { ln_det_F, det_F_minus_1 };

/// Words of the scene file for the enumerators.
std::string_view word(LawName law);
std::string_view word(PressureSpace pressure);
std::string_view word(Constraint constraint);

/// All words, in the order of the enumerators.
std::span<const std::string_view> lawWords();
std::span<const std::string_view> pressureWords();
std::span<const std::string_view> constraintWords();

/// True for the laws that are used with det F = 1, which therefore need a pressure.
bool isIncompressible(LawName law);

}  // namespace palpate
