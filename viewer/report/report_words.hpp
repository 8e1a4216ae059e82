#pragma once

#include "viewer/report/report.hpp"

// Words and numbers that the text and the page of a report share.

namespace palpate {

/// One sentence: what the errors are measured with.
std::string describeHeldOut(const Report& report);

/// A sentence for each method that could not be made for some, but not all active nodes.
std::vector<std::string> describeGaps(const Report& report);

/// What to do for better held-out solutions; empty when there are probes.
std::string hintForProbes(const Report& report);

/// What the probes of a finger's area say of it, or how to get some.
std::string describeProbes(const AreaMeasures& area, const Report& report);

/// "max(3 % of |force|, 0.01 N), as the scene asks".
std::string describeTarget(const Report& report);

/// "493 nodes, 1717 tetrahedra".
std::string describeMesh(const Mesh& mesh);

/// "ball of 100 mm, spacing 20 mm".
std::string describeBall(const Dataset& dataset);

/// "4.2 MB"; decimal units, as disks are sold.
std::string formatBytes(double bytes);

/// Three figures at most, "-" for NaN: "0.00012", "1.2e-06", "34", "12300".
std::string formatNumber(double value, int figures = 2);

/// "123", "123.4" for a mean.
std::string formatCount(double count);

/// "99.5 %", "-" for NaN; never rounds up to 100 %.
std::string formatShare(double share);

/// Breaks a text at spaces into lines of at most 100 columns. Its first line begins in column
/// `indent`, which the others are indented to.
std::string wrapped(const std::string& text, std::size_t indent = 0);

}  // namespace palpate
