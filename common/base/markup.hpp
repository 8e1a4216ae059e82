#pragma once

#include <map>
#include <string>
#include <string_view>

// Text for HTML, XML and SVG.

namespace palpate {

/// Escapes text for use between tags and in quoted attributes.
std::string escaped(std::string_view text);

/// Escapes JSON for use in a <script>, so that no text in it ends the script.
std::string scriptJson(std::string json);

/// Replaces names in double braces by their values in `by`, which must contain every name.
std::string filledMarkup(std::string_view text,
                         const std::map<std::string, std::string, std::less<>>& by);

}  // namespace palpate
