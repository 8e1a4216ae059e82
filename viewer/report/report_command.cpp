#include "viewer/report/report_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "common/base/whole_file.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

constexpr std::size_t pictured_nodes = 6;

std::function<ExitCode()> prepareReport(CLI::App& app) {
  auto options = std::make_shared<ReportCommandOptions>();
  app.add_option("DATASET", options->report.datasets,
                 "Sealed dataset, OUT.h5; more of the same scene "
                 "with other spacings or accuracies add points to the curves")
      ->required()
      ->type_name("FILE");
  app.add_option("--methods", options->report.methods,
                 fmt::format("Only these, separated by commas; there are {}",
                             fmt::join(forceFieldMethods(), ", ")))
      ->delimiter(',')
      ->type_name("LIST");
  app.add_option("--html", options->html, "Write a self-contained page with plots to FILE too")
      ->type_name("FILE");
  app.add_flag("--json", options->json, "One JSON object instead of the table (docs/commands.md)");
  return [options] { return report(*options, std::cout); };
}

}  // namespace

ExitCode report(const ReportCommandOptions& options, std::ostream& output) {
  // Before minutes of measuring, not after.
  if (!options.html.empty()) refuseUnwritable(options.html, "--html");
  ReportOptions wanted = options.report;
  // Text and JSON show no pictures, and sampling fields for them takes a while.
  wanted.pictured_nodes = options.html.empty() ? 0 : pictured_nodes;
  const Report report = makeReport(wanted);
  if (!options.html.empty()) replaceFile(options.html, reportPage(report), "page");
  output << (options.json ? reportJson(report) : reportText(report));
  return ExitCode::done;
}

Verb reportVerb() {
  return {"report", "How accurate and how fast the methods of interpolation are on a dataset",
          prepareReport};
}

}  // namespace palpate
