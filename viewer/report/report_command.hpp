#pragma once

#include <iosfwd>

#include "common/base/program.hpp"
#include "viewer/report/report.hpp"

namespace palpate {

struct ReportCommandOptions {
  ReportOptions report;
  std::filesystem::path html;  ///< empty: no page
  bool json = false;

  void addTo(CLI::App& app);  ///< declares the options of the verb
};

/// Runs `palpate report`. Measures every interpolation method on a dataset, and prints a table or
/// one JSON object; with ReportCommandOptions::html also writes the page. If two datasets are of
/// different scenes, compares the datasets instead.
///
/// Throws Error (bad input) like makeReport() and compareDatasets(), and if the page would replace
/// a dataset. Throws Error if the page cannot be written; no file is left then.
void report(const ReportCommandOptions& options, std::ostream& output);

/// The verb `report` of palpate-answers, which writes to standard output.
extern const Verb report_verb;

}  // namespace palpate
