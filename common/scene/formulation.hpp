#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace palpate {

/// Strain energy W of the tissue. Words of the scene file: "linear", "st-venant-kirchhoff",
/// "modified-st-venant-kirchhoff", "mooney-rivlin", "neo-hookean", "yeoh", "ogden",
/// "veronda-westmann", "holzapfel-gasser-ogden".
enum class LawName : std::uint8_t {
  linear,
  st_venant_kirchhoff,
  modified_st_venant_kirchhoff,
  mooney_rivlin,
  neo_hookean,
  yeoh,
  ogden,
  veronda_westmann,
  holzapfel_gasser_ogden
};
/// Displacement space: "P1" (4-node tetrahedra) or "P2" (10-node tetrahedra with straight edges).
enum class DisplacementSpace : std::uint8_t { p1, p2 };
/// Pressure space:
/// - "none";
/// - "P1": with P1 displacement the paper's equal-order element, which violates the inf-sup
///   condition; with P2 displacement the Taylor-Hood element;
/// - "P1-stabilized": for P1 displacement, stabilised by polynomial pressure projection;
/// - "P2": for P2 displacement, the paper's quadratic equal-order element, which violates the
///   inf-sup condition.
enum class PressureSpace : std::uint8_t { none, p1, p1_stabilized, p2 };
/// Form of the constraint det F = 1: "ln-det-F" (default, a barrier that keeps elements from
/// inverting) or "det-F-1" (used by the paper and GetFEM).
enum class Constraint : std::uint8_t { ln_det_F, det_F_minus_1 };

/// How a tool prescribes the displacements of a patch of nodes:
/// - "rigid" moves all nodes of the patch, which may be a single node, by the tool's displacement;
/// - "weighted-average" prescribes only the weighted mean of the nodes' displacements;
/// - "finger" prescribes the weighted mean around a point that may be anywhere on the surface.
enum class ToolKind : std::uint8_t { rigid, weighted_average, finger };

/// Words that stand for the enumerators of Choice in the scene file, in order. Each enum that a
/// scene uses has a specialisation.
template <class Choice>
inline constexpr std::array<std::string_view, 0> words_of = {};
template <>
inline constexpr auto words_of<LawName> = std::to_array<std::string_view>(
    {"linear", "st-venant-kirchhoff", "modified-st-venant-kirchhoff", "mooney-rivlin",
     "neo-hookean", "yeoh", "ogden", "veronda-westmann", "holzapfel-gasser-ogden"});
template <>
inline constexpr auto words_of<DisplacementSpace> = std::to_array<std::string_view>({"P1", "P2"});
template <>
inline constexpr auto words_of<PressureSpace> =
    std::to_array<std::string_view>({"none", "P1", "P1-stabilized", "P2"});
template <>
inline constexpr auto words_of<Constraint> = std::to_array<std::string_view>({"ln-det-F",
                                                                              "det-F-1"});
template <>
inline constexpr auto words_of<ToolKind> =
    std::to_array<std::string_view>({"rigid", "weighted-average", "finger"});

/// Returns the word of an enumerator; it has static lifetime.
template <class Choice>
requires(!words_of<Choice>.empty()) constexpr std::string_view word(Choice choice) {
  return words_of<Choice>.at(static_cast<std::size_t>(choice));
}

}  // namespace palpate
