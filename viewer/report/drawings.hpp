#pragma once

#include <nlohmann/json.hpp>

#include "viewer/report/comparison.hpp"
#include "viewer/report/report.hpp"

// Arrays for the drawings of the pages (page/report.js), and the sentences that pages share with
// the text. SI units, rounded to a few digits; null for missing numbers.

namespace palpate {

nlohmann::ordered_json drawingsOf(const Report& report);
nlohmann::ordered_json drawingsOf(const Comparison& comparison);

}  // namespace palpate
