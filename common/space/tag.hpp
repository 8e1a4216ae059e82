#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace palpate {

/// State of a lattice point, one of the four in the paper. Files contain the values, so never
/// change one; only append.
enum class Tag : std::uint8_t {
  unknown = 0,      ///< not reached yet; does not occur in a complete build
  expandable = 1,   ///< solved, and transitions to its neighbours may start here
  terminating = 2,  ///< solved, but |force| > max_force; stored, but no transition starts here
  failed = 3,       ///< no transition from an expandable neighbour converged; see Cause
};

/// Returns whether points with this tag hold an equilibrium.
constexpr bool isSolved(Tag tag) { return tag == Tag::expandable || tag == Tag::terminating; }

/// The words that name() returns, by value of the tag.
inline constexpr std::array<std::string_view, 4> tag_words = {"unknown", "expandable",
                                                              "terminating", "failed"};
/// Returns "unknown", "expandable", "terminating" or "failed".
constexpr std::string_view name(Tag tag) { return tag_words.at(static_cast<std::size_t>(tag)); }
/// Returns the tag with this value in a file, or nullopt.
constexpr std::optional<Tag> tagOf(std::uint32_t value) {
  return value < tag_words.size() ? std::optional(static_cast<Tag>(value)) : std::nullopt;
}

}  // namespace palpate
