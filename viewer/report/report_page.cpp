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

std::string filledPage(const std::string& title, const nlohmann::ordered_json& report) {
  return filledMarkup(report_markup, {{"title", escaped(title)},
                                      {"report", scriptJson(jsonText(report))},
                                      {"script", report_script}});
}

}  // namespace

std::string reportPage(const Report& report) {
  nlohmann::ordered_json json = toJson(report);
  json["drawings"] = drawingsOf(report);
  return filledPage(report.open.front().scene().name + ": accuracy and speed", json);
}

std::string comparisonPage(const Comparison& comparison) {
  nlohmann::ordered_json json = toJson(comparison);
  json["drawings"] = drawingsOf(comparison);
  return filledPage(
      fmt::format("{} and {}", comparison.open[0].scene().name, comparison.open[1].scene().name),
      json);
}

}  // namespace palpate
