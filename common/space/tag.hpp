#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace palpate {

/// State of a lattice point: exactly the paper's four. Values are part of every file: only append.
enum class Tag : std::uint8_t {
  unknown = 0,      ///< not reached yet; no point of a complete build
  expandable = 1,   ///< solved, and transitions to its neighbours may start here
  terminating = 2,  ///< solved, |force| > max_force: kept, but nothing starts here
  failed = 3,       ///< every expandable neighbour was tried within the budget; a Cause says why
};

/// True for the tags of points that hold an equilibrium.
constexpr bool isSolved(Tag tag) { return tag == Tag::expandable || tag == Tag::terminating; }

/// The words of name(), by value.
inline constexpr std::array<std::string_view, 4> tag_words = {"unknown", "expandable",
                                                              "terminating", "failed"};
/// "unknown", "expandable", "terminating" or "failed".
constexpr std::string_view name(Tag tag) { return tag_words.at(static_cast<std::size_t>(tag)); }
/// The tag with this value in a file; nothing when there is none.
constexpr std::optional<Tag> tagOf(std::uint32_t value) {
  return value < tag_words.size() ? std::optional(static_cast<Tag>(value)) : std::nullopt;
}

}  // namespace palpate
