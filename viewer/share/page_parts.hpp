#pragma once

#include <string_view>

namespace palpate {

/// The parts of every page, which this program contains: the files of `page`, and the fields in
/// WebAssembly. `script` concatenates many files (CMakeLists.txt has their order); `field` is empty
/// if the build did not find Emscripten.
struct PageParts {
  std::string_view markup, style, trouble, script, worker, field;
};
PageParts pageParts();

}  // namespace palpate
