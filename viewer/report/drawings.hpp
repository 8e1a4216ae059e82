#pragma once

#include <nlohmann/json.hpp>

#include "viewer/report/comparison.hpp"
#include "viewer/report/report.hpp"

// The arrays that the pages draw (page/report.js), and the sentences that they share with the text.
// SI units, rounded to a few digits; numbers that do not exist are null.

namespace palpate {

nlohmann::ordered_json drawingsOf(const Report& report);
nlohmann::ordered_json drawingsOf(const Comparison& comparison);

}  // namespace palpate
