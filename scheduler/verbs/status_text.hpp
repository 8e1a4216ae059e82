#pragma once

#include "common/scene/scene.hpp"
#include "common/space/space_table.hpp"
#include "proto/palpate.pb.h"

namespace palpate {

/// Summarises a finished build; ends with a line feed. Lists the points of each space by tag, and
/// the failures by cause. If there are many spaces, lists only those with most failures, and the
/// sum. For an adaptive scene whose dataset is not partial, also gives the fraction of the
/// workspace in which the accuracy is met.
std::string summaryOf(const SpaceRowsList& spaces, const Scene& scene, bool partial = false);

/// Formats the status as a page of text that ends with a line feed.
std::string describe(const wire::Status& status);

/// Formats the progress of a build in one line: "312/515 points, 7 s left, 28.1/s, 2 workers,
/// 40 ready". Drops parts from the end that do not fit in `columns`, but always keeps the points.
std::string progressLine(const wire::Status& status, std::size_t columns = std::string::npos);

/// Formats a bar and the progress line after it, to be redrawn on a terminal of `columns` columns.
/// Never fills the last column, where some terminals start a new row.
std::string progressBar(const wire::Status& status, std::size_t columns);

/// Formats a lattice point in spacings, "(1, 0.5, 0)". The coordinates of `point` are in units of a
/// spacing / `divisions`.
std::string pointText(const LatticePoint& point, std::int32_t divisions);

/// Formats a duration: "7 s", "12 min", "3 h 20 min".
std::string durationText(double seconds);

}  // namespace palpate
