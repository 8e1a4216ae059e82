#pragma once

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

/// "unknown", "expandable", "terminating" or "failed".
std::string_view name(Tag tag);
/// The tag with this value in a file; nothing when there is none.
std::optional<Tag> tagOf(std::uint32_t value);

}  // namespace palpate
