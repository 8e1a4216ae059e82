#pragma once

#include "common/scene/scene.hpp"
#include "common/space/space_table.hpp"
#include "proto/palpate.pb.h"

namespace palpate {

/// A finished build: counts per tag of each space (the ones with most failures and the sum, when
/// there are many), failures by cause, and, unless the dataset is partial, how far an adaptive
/// scene's accuracy was reached. Line feed at the end.
std::string summaryOf(const SpaceRowsList& spaces, const Scene& scene, bool partial = false);

/// The status as a page of text for people, with a line feed at the end.
std::string describe(const wire::Status& status);

/// How far a build is, in one line: "312/515 points, 7 s left, 28.1/s, 2 workers, frontier 40". In
/// at most `columns`, what matters least goes first; the points are always there.
std::string progressLine(const wire::Status& status, std::size_t columns = std::string::npos);

/// The same behind a bar, to be drawn again and again on a terminal of so many columns: it never
/// fills the last one, where some terminals begin a new row.
std::string progressBar(const wire::Status& status, std::size_t columns);

/// A point of a lattice whose coordinates count in 1/divisions of a spacing, in spacings:
/// "(1, 0.5, 0)".
std::string pointText(const LatticePoint& point, std::int32_t divisions);

/// "7 s", "12 min", "3 h 20 min".
std::string durationText(double seconds);

}  // namespace palpate
