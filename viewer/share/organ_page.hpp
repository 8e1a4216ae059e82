#pragma once

#include <string>

#include "viewer/organ/carried_organ.hpp"

namespace palpate {

/// Whether this palpate was built with Emscripten, so that it has the fields for pages.
bool hasPageField();
/// Error where it was not, which says what to do.
void requirePageField();

/// One HTML file that needs no other, no server and no network: the organ in WebGL, the fields in
/// WebAssembly. Error as of requirePageField().
std::string organPage(const CarriedOrgan& organ);

}  // namespace palpate
