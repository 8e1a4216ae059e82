#pragma once

#include <string>
#include <vector>

namespace palpate {

/// The style sheet of the page, for elements and for the classes of its plots.
extern const char* const page_style;

/// A table of rows (tableRow) under titles, which are plain text.
std::string table(const std::vector<std::string>& titles, const std::string& rows);

/// A row of cells, plain text, that ends with `end`, HTML.
std::string tableRow(const std::vector<std::string>& cells, const std::string& end = "");

/// A cell with a bar as long as `value` is of `largest`.
std::string barCell(double value, double largest);

/// A box with something to notice, plain text; nothing when it is empty.
std::string note(const std::string& text);

/// Drawings side by side.
std::string figures(const std::string& content);

}  // namespace palpate
