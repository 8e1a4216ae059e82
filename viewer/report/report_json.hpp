#pragma once

#include <nlohmann/json.hpp>

namespace palpate {

struct Comparison;
struct Report;

/// What `report --json` prints (docs/commands.md).
nlohmann::ordered_json toJson(const Report& report);
nlohmann::ordered_json toJson(const Comparison& comparison);

/// On one line. Numbers that do not exist are null, bytes that are no UTF-8 are replaced.
std::string jsonText(const nlohmann::ordered_json& json);

}  // namespace palpate
