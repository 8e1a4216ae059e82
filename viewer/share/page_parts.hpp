#pragma once

#include <string_view>

namespace palpate {

/// The parts that all pages share, embedded in this program: the files of the folder `page`, and
/// the fields in WebAssembly. `script` is the concatenation of many files, in the order of
/// CMakeLists.txt. `field` is empty if the build did not find Emscripten.
struct PageParts {
  std::string_view markup, style, trouble, script, worker, field;
};
PageParts pageParts();

}  // namespace palpate
