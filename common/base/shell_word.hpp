#pragma once

#include <string>
#include <string_view>

namespace palpate {

/// A file's name as one word of a POSIX shell, for commands that people paste: quoted where it
/// needs to be, and none of the options of a program.
std::string shellWord(std::string_view file);

}  // namespace palpate
