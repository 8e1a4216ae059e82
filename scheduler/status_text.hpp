#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "proto/palpate.pb.h"

namespace palpate {

/// Points by tag, a row for each active node; of more than 24 those that tell most, and a sum.
/// `with_stages`: and what each is working on.
std::string pointTable(std::vector<wire::SpaceStatus> spaces, bool with_stages);

/// "TITLE: 1 step_budget, 11 unreachable" and a line feed; nothing when there is none.
std::string causesLine(const char* title, const std::map<std::string, std::int32_t>& causes);

/// The status as a page of text for people, with a line feed at the end.
std::string describe(const wire::Status& status);

/// How far a build is, in one line: "312/515 points, 7 s left, 28.1/s, 2 workers, frontier 40". In
/// at most `columns`, what matters least goes first; the points are always there.
std::string progressLine(const wire::Status& status, std::size_t columns = std::string::npos);

/// The same behind a bar, to be drawn again and again on a terminal of so many columns: it never
/// fills the last one, where some terminals begin a new row.
std::string progressBar(const wire::Status& status, std::size_t columns);

/// "7 s", "12 min", "3 h 20 min".
std::string durationText(double seconds);

}  // namespace palpate
