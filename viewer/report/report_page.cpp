#include <fmt/format.h>

#include "viewer/report/html_elements.hpp"
#include "viewer/report/report_sections.hpp"
#include "viewer/report/report_words.hpp"

namespace palpate {

std::string reportPage(const Report& report) {
  const std::vector<Section> sections = {
      frontierSection(report), loopsSection(report), boundsSection(report),
      nodesSection(report),    mapsSection(report),  curvesSection(report),
      failuresSection(report), sizesSection(report), provenanceSection(report)};
  std::string links, text;
  for (const Section& section : sections) {
    links += fmt::format("<a href=\"#{}\">{}</a>", section.id, section.heading);
    text += fmt::format("<h2 id=\"{}\">{}</h2>\n<p class=\"how\">{}</p>\n{}", section.id,
                        section.heading, section.how, section.content);
  }
  const Scene& scene = report.open.front().scene();
  return fmt::format(
             "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
             "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
             "<title>{0}: speed against error</title>\n<style>{1}</style></head>\n<body><main>\n"
             "<h1>{0}: how accurate, and how fast</h1>\n<p class=\"lead\">{2}, {3}. {4}</p>\n",
             escaped(scene.name), page_style, countNodes(report.nodes.size()),
             escaped(scene.mesh.filename().string()), escaped(describeHeldOut(report))) +
         note(hintForProbes(report)) + cards(report) + "<nav>" + links + "</nav>\n" + text +
         "</main></body></html>\n";
}

}  // namespace palpate
