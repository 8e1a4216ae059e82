#pragma once

#include <nlohmann/json.hpp>

#include "viewer/report/comparison.hpp"
#include "viewer/report/report.hpp"

// Arrays for the drawings of the pages (page/report.js), and the sentences that the pages share
// with the text. Numbers are in SI units and rounded to a few digits; a missing number is null.

namespace palpate {

nlohmann::ordered_json drawingsOf(const Report& report);
nlohmann::ordered_json drawingsOf(const Comparison& comparison);

}  // namespace palpate
