#include "scheduler/events/event.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/log_lines.hpp"

namespace palpate {
namespace {

/// In the order of EventKind.
constexpr std::array<std::string_view, 20> event_words = {
    "started",        "stopped",     "completed",    "sealed",         "stage",
    "failed_attempt", "set_aside",   "retried",      "priority",       "paused",
    "resumed",        "disputed",    "kept_out",     "damaged",        "worker_joined",
    "worker_left",    "worker_lost", "worker_ended", "worker_refused", "left_out"};
static_assert(event_words.size() == static_cast<std::size_t>(EventKind::left_out) + 1);

std::string quoted(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// As exactly as anybody reads it.
std::string numberText(double number) {
  return std::isfinite(number) ? fmt::format("{:.6g}", number) : "null";
}

}  // namespace

std::string_view name(EventKind kind) { return event_words.at(static_cast<std::size_t>(kind)); }

std::span<const std::string_view> eventWords() { return event_words; }

Event& Event::addValue(std::string_view field, std::string_view json) {
  fields_ += fmt::format(",\"{}\":{}", field, json);
  return *this;
}

Event& Event::with(std::string_view field, std::string_view text) {
  return addValue(field, quoted(text));
}

Event& Event::with(std::string_view field, std::int64_t number) {
  return addValue(field, std::to_string(number));
}

Event& Event::with(std::string_view field, double number) {
  return addValue(field, numberText(number));
}

Event& Event::with(std::string_view field, bool yes) {
  return addValue(field, yes ? "true" : "false");
}

Event& Event::with(std::string_view field, const std::array<double, 3>& place) {
  return addValue(field, fmt::format("[{}]", fmt::join(place, ",")));
}

std::string Event::line(std::chrono::system_clock::time_point when) const {
  return fmt::format(R"({{"time":"{}","event":"{}"{}}})", utcText(when), name(kind_), fields_);
}

}  // namespace palpate
