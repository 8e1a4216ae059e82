#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace palpate {

/// `contact`, the key: how a tool touches the body in the haptic client. It changes no
/// configuration and no id, and is left out of a resolved scene that says nothing.
enum class ContactMode : std::uint8_t {
  unilateral,  ///< the tissue pushes the tool away and never pulls; the tool slides with friction
  glued        ///< the tool holds the surface and can pull it too (the paper's mode)
};

/// "unilateral" or "glued", in scenes, options and recordings.
std::string_view word(ContactMode mode);
/// All words, in the order of the enumerators.
std::span<const std::string_view> contactWords();

}  // namespace palpate
