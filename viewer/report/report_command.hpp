#pragma once

#include <iosfwd>

#include "common/base/program.hpp"
#include "viewer/report/report.hpp"

namespace palpate {

struct ReportCommandOptions {
  ReportOptions report;
  std::filesystem::path html;  ///< empty: no page
  bool json = false;
};

/// Runs `palpate report`: measures every interpolation method on a dataset and prints a table or
/// one JSON object. Writes the page if requested. Compares two datasets if they are of different
/// scenes. Throws Error (bad input) like makeReport and compareDatasets, and if the page would
/// replace a dataset; throws Error if the page cannot be written, and then leaves no file.
ExitCode report(const ReportCommandOptions& options, std::ostream& output);

/// Returns the verb `report` of palpate-answers, which writes to standard output.
Verb reportVerb();

}  // namespace palpate
