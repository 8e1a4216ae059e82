#pragma once

#include <map>
#include <string>
#include <string_view>

// HTML, XML and SVG.

namespace palpate {

/// Text as it may stand between tags and in quoted attributes.
std::string escaped(std::string_view text);

/// JSON as it may stand in a <script>: no text in it ends the script.
std::string scriptJson(std::string json);

/// `text` with the values of `by` in place of their names in double braces. Every name is in `by`.
std::string filledMarkup(std::string_view text,
                         const std::map<std::string, std::string, std::less<>>& by);

}  // namespace palpate
