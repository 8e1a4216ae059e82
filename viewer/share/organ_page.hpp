#pragma once

#include <string>

#include "viewer/organ/carried_organ.hpp"

namespace palpate {

/// Whether this palpate was built with Emscripten, so that it contains the fields for pages.
bool hasPageField();
/// Error if it was not, with advice.
void requirePageField();

/// Returns one HTML file that needs no other file, no server and no network: the organ in WebGL,
/// the fields in WebAssembly. Error as in requirePageField().
std::string organPage(const CarriedOrgan& organ);

}  // namespace palpate
