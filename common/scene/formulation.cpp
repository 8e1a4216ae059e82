#include "common/scene/formulation.hpp"

#include <array>

namespace palpate {
namespace {

constexpr std::array<std::string_view, 9> law_words = {
    "linear",        "st-venant-kirchhoff", "modified-st-venant-kirchhoff",
    "mooney-rivlin", "neo-hookean",         "yeoh",
    "ogden",         "veronda-westmann",    "holzapfel-gasser-ogden"};
constexpr std::array<std::string_view, 2> displacement_words = {"P1", "P2"};
constexpr std::array<std::string_view, 4> pressure_words = {"none", "P1", "P1-stabilized", "P2"};
constexpr std::array<std::string_view, 2> tool_words = {"rigid", "weighted-average"};
constexpr std::array<std::string_view, 2> constraint_words = {"ln-det-F", "det-F-1"};

}  // namespace

std::span<const std::string_view> lawWords() { return law_words; }
std::span<const std::string_view> displacementWords() { return displacement_words; }
std::span<const std::string_view> pressureWords() { return pressure_words; }
std::span<const std::string_view> constraintWords() { return constraint_words; }

std::span<const std::string_view> toolWords() { return tool_words; }

std::string_view word(LawName law) { return law_words.at(static_cast<std::size_t>(law)); }
std::string_view word(PressureSpace pressure) {
  return pressure_words.at(static_cast<std::size_t>(pressure));
}
std::string_view word(Constraint constraint) {
  return constraint_words.at(static_cast<std::size_t>(constraint));
}
std::string_view word(DisplacementSpace displacement) {
  return displacement_words.at(static_cast<std::size_t>(displacement));
}
std::string_view word(ToolKind tool) { return tool_words.at(static_cast<std::size_t>(tool)); }

}  // namespace palpate
