#pragma once

#include <cstddef>
#include <string_view>

namespace palpate {

/// The line, from 1, of a scene that a sentence about it begins with: "[fixed] ..." is that of the
/// table, "fixed.group: ..." of the key, `active "tip": ...` of that name, "mesh = ..." and "the
/// mesh ..." of the mesh. 0 when the sentence begins with nothing that is there, or with a key
/// of several tables of which its first quoted word names none; of an unknown active node the first
/// one is meant. Errors of what
/// only the mesh shows know no line: the scene was read before.
std::size_t lineOfKey(std::string_view scene_text, std::string_view sentence);

}  // namespace palpate
