#pragma once

#include <spdlog/formatter.h>

#include <chrono>
#include <memory>
#include <string>

namespace palpate {

/// Returns a formatter that writes every log line as one JSON object: time (utcText), level
/// ("info", "warning", ...), program, verb, pid, message. Invalid UTF-8 is replaced.
std::unique_ptr<spdlog::formatter> jsonLines(std::string program, std::string verb);

/// Returns a time in UTC as text, such as "2026-11-24T20:17:59.123Z". Such texts sort by time.
std::string utcText(std::chrono::system_clock::time_point when);

}  // namespace palpate
