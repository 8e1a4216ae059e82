#pragma once

#include <string>

#include "viewer/organ/carried_organ.hpp"

namespace palpate {

/// Returns whether this palpate was built with Emscripten and thus contains the fields in
/// WebAssembly, which every page needs.
bool hasPageField();
/// Error, with advice, if !hasPageField().
void requirePageField();

/// Returns an HTML file that shows the organ in WebGL and computes its forces in WebAssembly. It
/// needs no other file, no server and no network. Error as in requirePageField().
std::string organPage(const CarriedOrgan& organ);

}  // namespace palpate
