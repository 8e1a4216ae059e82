#include "common/space/tag.hpp"

#include <array>

namespace palpate {
namespace {

constexpr std::array<std::string_view, 4> tag_words = {"unknown", "expandable", "terminating",
                                                       "failed"};

}  // namespace

std::string_view name(Tag tag) { return tag_words.at(static_cast<std::size_t>(tag)); }

std::optional<Tag> tagOf(std::uint32_t value) {
  return value < tag_words.size() ? std::optional(static_cast<Tag>(value)) : std::nullopt;
}

}  // namespace palpate
