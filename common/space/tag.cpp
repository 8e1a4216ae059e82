#include "common/space/tag.hpp"

#include <array>

namespace palpate {
namespace {
constexpr std::array<std::string_view, 4> words = {"unknown", "expandable", "terminating",
                                                   "failed"};
}

std::string_view name(Tag tag) { return words.at(static_cast<std::size_t>(tag)); }

std::optional<Tag> tagNamed(std::string_view word) {
  for (std::size_t i = 0; i < words.size(); ++i)
    if (words[i] == word) return static_cast<Tag>(i);
  return std::nullopt;
}

}  // namespace palpate
