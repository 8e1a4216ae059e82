#include "viewer/report/report_page.hpp"

#include <fmt/format.h>

#include "common/base/markup.hpp"
#include "viewer/report/drawings.hpp"
#include "viewer/report/report_json.hpp"

namespace palpate {

/// The texts of page/report.html and page/report.js, which CMake embeds.
extern const char* const report_markup;
extern const char* const report_script;

namespace {

/// Returns the page of a report or comparison.
template <class Shown>
std::string filledPage(const std::string& title, const Shown& shown) {
  nlohmann::ordered_json json = toJson(shown);
  json["drawings"] = drawingsOf(shown);
  return filledMarkup(report_markup, {{"title", escaped(title)},
                                      {"report", scriptJson(jsonText(json))},
                                      {"script", report_script}});
}

}  // namespace

std::string reportPage(const Report& report) {
  return filledPage(report.open.front().scene().name + ": accuracy and speed", report);
}

std::string comparisonPage(const Comparison& comparison) {
  return filledPage(
      fmt::format("{} and {}", comparison.open[0].scene().name, comparison.open[1].scene().name),
      comparison);
}

}  // namespace palpate
