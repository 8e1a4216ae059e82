#include "viewer/report/report_page.hpp"

#include <fmt/format.h>

#include "viewer/plot/svg_plot.hpp"
#include "viewer/report/dataset_sections.hpp"
#include "viewer/report/html_elements.hpp"
#include "viewer/report/method_sections.hpp"
#include "viewer/report/node_sections.hpp"
#include "viewer/report/report_words.hpp"

namespace palpate {

std::string reportPage(const Report& report) {
  const Scene& scene = report.open.front().scene();
  static constexpr const char* links =
      R"(<nav><a href="#frontier">Speed against error</a><a href="#loops">Closed loops</a>)"
      R"(<a href="#bounds">Error bounds</a><a href="#nodes">Active nodes</a>)"
      R"(<a href="#maps">Where the error is</a><a href="#curves">Force along the axes</a>)"
      R"(<a href="#failures">Failures</a><a href="#sizes">Sizes</a>)"
      R"(<a href="#provenance">Scene and provenance</a></nav>)"
      "\n";
  return fmt::format(
             "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
             "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
             "<title>{0}: speed against error</title>\n<style>{1}</style></head>\n<body><main>\n"
             "<h1>{0}: how accurate, and how fast</h1>\n<p class=\"lead\">{2}, {3}. {4}</p>\n",
             escaped(scene.name), page_style, countNodes(report.nodes.size()),
             escaped(scene.mesh.filename().string()), escaped(describeHeldOut(report))) +
         note(hintForProbes(report)) + cards(report) + links + frontierSection(report) +
         loopsSection(report) + boundsSection(report) + nodesSection(report) + mapsSection(report) +
         curvesSection(report) + failuresSection(report) + sizesSection(report) +
         provenanceSection(report) + "</main></body></html>\n";
}

}  // namespace palpate
