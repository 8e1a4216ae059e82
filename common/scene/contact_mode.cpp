#include "common/scene/contact_mode.hpp"

#include <array>

namespace palpate {
namespace {

constexpr std::array<std::string_view, 2> contact_words = {"unilateral", "glued"};

}  // namespace

std::string_view word(ContactMode mode) { return contact_words.at(static_cast<std::size_t>(mode)); }

std::span<const std::string_view> contactWords() { return contact_words; }

}  // namespace palpate
