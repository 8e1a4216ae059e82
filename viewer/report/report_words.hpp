#pragma once

#include "viewer/report/report.hpp"

// Words and numbers shared by the text and the page of a report.

namespace palpate {

/// Returns one sentence about the held-out solutions.
std::string describeHeldOut(const Report& report);

/// Returns a sentence for each method that could be made for some, but not all, active nodes.
std::vector<std::string> describeGaps(const Report& report);

/// Returns advice on how to get better held-out solutions; empty if there are probes or areas.
std::string hintForProbes(const Report& report);

/// Returns the results at the probes of a finger's area, or advice on how to get probes.
std::string describeProbes(const AreaMeasures& area, const Report& report);

/// Returns the accuracy target as text: "max(3 % of |force|, 0.01 N) (set by the scene)".
std::string describeTarget(const Report& report);

/// Returns the size of a mesh as text: "493 nodes, 1717 tetrahedra".
std::string describeMesh(const Mesh& mesh);

/// Returns the workspace ball as text: "ball of 100 mm, spacing 20 mm".
std::string describeBall(const Dataset& dataset);

/// Returns a size such as "4.2 MB", in decimal units, as on the labels of disks.
std::string formatBytes(double bytes);

/// Returns a number with few digits, or "-" for NaN: "0.0012", "1.2e-06", "34", "12300".
std::string formatNumber(double value, int figures = 2);

/// Returns "12" for a whole number, "12.3" for a mean; no decimals from 100 on.
std::string formatCount(double count);

/// Returns a fraction as "99.5 %", or "-" for NaN. Never rounds up to 100 %.
std::string formatShare(double share);

}  // namespace palpate
