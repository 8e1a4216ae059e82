#pragma once

#include <map>
#include <string>
#include <string_view>

// Text for HTML, XML and SVG.

namespace palpate {

/// Escapes text for use between tags and in quoted attributes.
std::string escaped(std::string_view text);

/// Escapes JSON for use in a <script> element, so that a string in the JSON cannot end the element.
std::string scriptJson(std::string json);

/// Replaces each name in double braces, as in {{title}}, by its value in `by`, which must contain
/// every name that occurs.
std::string filledMarkup(std::string_view text,
                         const std::map<std::string, std::string, std::less<>>& by);

}  // namespace palpate
