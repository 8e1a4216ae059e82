#include "scheduler/events/event.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/log_lines.hpp"

namespace palpate {

Event& Event::addJson(std::string_view field, std::string_view json) {
  fields_ += fmt::format(",\"{}\":{}", field, json);
  return *this;
}

Event& Event::with(std::string_view field, std::string_view text) {
  constexpr auto replace = nlohmann::json::error_handler_t::replace;
  return addJson(field, nlohmann::json(text).dump(-1, ' ', false, replace));
}

Event& Event::with(std::string_view field, double number) {
  return addJson(field, std::isfinite(number) ? fmt::format("{:.6g}", number) : "null");
}

Event& Event::with(std::string_view field, const std::array<double, 3>& place) {
  return addJson(field, fmt::format("[{}]", fmt::join(place, ",")));
}

std::string Event::line(std::chrono::system_clock::time_point when) const {
  return fmt::format(R"({{"time":"{}","event":"{}"{}}})", utcText(when), word_, fields_);
}

}  // namespace palpate
