#pragma once

#include <string>
#include <string_view>

namespace palpate {

/// Of a sentence, as peers say why they refuse something; names have less.
inline constexpr std::size_t longest_reason = 500;

/// What a peer sent, as it may be shown to people: at most so many bytes, with ? in place of all
/// that is not printable ASCII, so that it cannot move a cursor or begin a line of its own.
std::string printable(std::string_view text, std::size_t most = 64);

}  // namespace palpate
