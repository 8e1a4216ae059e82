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

/// `palpate report`: measures every method of interpolation of a dataset, prints a table for a
/// person or one JSON object, and writes the page when asked for. Two datasets that are not of one
/// scene are compared instead. Error (bad input) as makeReport and compareDatasets, and when the
/// page would replace a dataset; Error when it cannot be written (then it is not there at all).
ExitCode report(const ReportCommandOptions& options, std::ostream& output);

/// The verb `report` of palpate-answers, on standard output.
Verb reportVerb();

}  // namespace palpate
