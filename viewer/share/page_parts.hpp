#pragma once

#include <string_view>

namespace palpate {

/// What every page is made of: the files of `page`, and the fields in WebAssembly, all of them in
/// this program. `script` is many files, one after the other (CMakeLists.txt has their order);
/// `field` is empty when Emscripten was not there to make it.
struct PageParts {
  std::string_view markup, style, trouble, script, worker, field;
};
PageParts pageParts();

}  // namespace palpate
