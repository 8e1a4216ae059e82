#pragma once

#include <string>
#include <vector>

#include "viewer/report/report.hpp"

namespace palpate {

/// The report for a terminal: at most 100 columns, ends with a newline.
std::string reportText(const Report& report);

/// One sentence: what the errors are measured with. For people.
std::string describeReferences(const Report& report);

/// A sentence for each method that could not be made for some, but not all active nodes.
std::vector<std::string> describeGaps(const Report& report);

/// What to do for better references; empty when there are probes.
std::string hintForProbes(const Report& report);

/// "4.2 MB"; decimal units, as disks are sold.
std::string formatBytes(double bytes);

/// Three figures at most, "-" for NaN: "0.00012", "1.2e-06", "34", "12300".
std::string formatNumber(double value, int figures = 2);

/// "123", "123.4" for a mean.
std::string formatCount(double count);

/// "99.5 %", "-" for NaN; never rounds up to 100 %.
std::string formatShare(double share);

}  // namespace palpate
