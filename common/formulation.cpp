#include "common/formulation.hpp"

#include <array>

namespace palpate {
namespace {

constexpr std::array<std::string_view, 4> law_words = {"linear", "st-venant-kirchhoff",
                                                       "modified-st-venant-kirchhoff", "mooney-rivlin"};
constexpr std::array<std::string_view, 3> pressure_words = {"none", "P1", "P1-stabilized"};
constexpr std::array<std::string_view, 2> constraint_words = {"ln-det-F", "det-F-1"};

}  // namespace

std::span<const std::string_view> lawWords() {
  return law_words;
}
std::span<const std::string_view> pressureWords() {
  return pressure_words;
}
std::span<const std::string_view> constraintWords() {
  return constraint_words;
}

std::string_view word(LawName law) {
  return law_words.at(static_cast<std::size_t>(law));
}
std::string_view word(PressureSpace pressure) {
  return pressure_words.at(static_cast<std::size_t>(pressure));
}
std::string_view word(Constraint constraint) {
  return constraint_words.at(static_cast<std::size_t>(constraint));
}

bool isIncompressible(LawName law) {
  return law == LawName::modified_st_venant_kirchhoff || law == LawName::mooney_rivlin;
}

}  // namespace palpate
