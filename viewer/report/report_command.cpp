#include "viewer/report/report_command.hpp"

#include <algorithm>
#include <iostream>

#include "common/base/error.hpp"
#include "common/base/required_option.hpp"
#include "common/base/whole_file.hpp"
#include "viewer/fields/field_choice.hpp"
#include "viewer/report/comparison.hpp"
#include "viewer/report/report_json.hpp"
#include "viewer/report/report_page.hpp"
#include "viewer/report/report_text.hpp"
#include "viewer/report/run_accuracy.hpp"

namespace palpate {
namespace {

constexpr std::size_t pictured_nodes = 6;

/// Returns the method that draws the curves of a comparison: the requested one, or the default.
std::string methodOf(const std::vector<std::string>& asked) {
  if (asked.size() > 1)
    throw badInput("--methods: give one method to compare two datasets, not {}", asked.size());
  return chosenMethods(asked).front();
}

/// Writes a report or a comparison.
template <class Shown>
void write(const ReportCommandOptions& options, const Shown& shown, std::ostream& output) {
  if (!options.html.empty()) replaceFile(options.html, pageOf(shown), "page");
  output << (options.json ? jsonText(toJson(shown)) : textOf(shown));
}

}  // namespace

void ReportCommandOptions::addTo(CLI::App& app) {
  addRequired(app, "DATASET", report.datasets,
              "Sealed datasets, OUT.h5; those of one scene with other spacings or accuracies add "
              "points to the curves; two of different organs or materials are compared. Or a "
              "recorded run and its scene, RUN.h5 SCENE.toml",
              "FILE");
  app.add_option("--methods", report.methods,
                 fmt::format("Methods to measure, separated by commas [all]: {}",
                             fmt::join(forceFieldMethods(), ", ")))
      ->delimiter(',')
      ->type_name("LIST");
  app.add_option("-o,--html", html, "Also write a self-contained page with plots to FILE")
      ->type_name("FILE");
  app.add_flag("--json", json, "One JSON object instead of the table (docs/commands.md)");
}

void report(const ReportCommandOptions& options, std::ostream& output) {
  // Check this before the measurements, which take minutes.
  if (!options.html.empty()) {
    refuseInput(options.html, "--html", options.report.datasets);
    refuseUnwritable(options.html, "--html");
  }
  const std::vector<std::filesystem::path>& files = options.report.datasets;
  if (files.size() == 2 && files[1].extension() == ".toml") {
    if (!options.report.methods.empty())
      throw badInput("--methods: omit it, because a recorded run has the method of each tick");
    return write(options, measureRun(files[0], files[1]), output);
  }
  std::vector<Dataset> open(options.report.datasets.begin(), options.report.datasets.end());
  std::ranges::for_each(open, warnIfPartial);
  if (open.size() == 2 && !sceneDifferences(open[0], open[1]).empty())
    return write(options,
                 compareDatasets(std::move(open), methodOf(options.report.methods), pictured_nodes),
                 output);
  ReportOptions wanted = options.report;
  // Text and JSON have no pictures, so the time for sampling can be saved.
  wanted.pictured_nodes = options.html.empty() ? 0 : pictured_nodes;
  write(options, makeReport(wanted, std::move(open)), output);
}

const Verb report_verb = {"report", "Accuracy and speed of the interpolation methods on a dataset",
                          prepareVerb<ReportCommandOptions, report, std::cout>};

}  // namespace palpate
