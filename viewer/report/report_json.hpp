#pragma once

#include <nlohmann/json.hpp>

namespace palpate {

struct Comparison;
struct Report;
struct RunAccuracy;

/// Return the output of `report --json` (docs/commands.md).
nlohmann::ordered_json toJson(const Report& report);
nlohmann::ordered_json toJson(const Comparison& comparison);
nlohmann::ordered_json toJson(const RunAccuracy& run);

/// Returns the JSON on one line. Missing numbers are null; bytes that are not UTF-8 are replaced.
std::string jsonText(const nlohmann::ordered_json& json);

}  // namespace palpate
