#pragma once

#include <spdlog/formatter.h>

#include <chrono>
#include <memory>
#include <string>

namespace palpate {

/// Formats every line of a log as one JSON object: time (utcText), level ("info", "warning", ...),
/// program, verb, pid, message. What a message holds is escaped; bytes that are no UTF-8 are
/// replaced.
std::unique_ptr<spdlog::formatter> jsonLines(std::string program, std::string verb);

/// "2026-11-24T20:17:59.123Z": UTC, so that the order of texts is that of times.
std::string utcText(std::chrono::system_clock::time_point when);

}  // namespace palpate
