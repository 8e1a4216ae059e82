#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace palpate {

/// The whole of a file. `what` ("scene", "mesh") names it in errors: Error (bad input) when it is a
/// directory or cannot be opened, Error when it cannot be read to its end.
std::string readText(const std::filesystem::path& file, std::string_view what);

}  // namespace palpate
