#include "scheduler/events/event_reader.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <ctime>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/base/log_lines.hpp"
#include "scheduler/events/event_log.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

/// Nothing: the line is no event.
std::optional<Json> parsedEvent(std::string_view line) {
  // Of an event are objects, and lists of numbers in them; to write more out would need a stack.
  constexpr int deepest = 8;
  const auto isShallow = [](int depth, Json::parse_event_t, Json&) { return depth < deepest; };
  Json event = Json::parse(line, isShallow, false);
  const auto isText = [&](const char* field) {
    const auto found = event.find(field);
    return found != event.end() && found->is_string();
  };
  if (!event.is_object() || !isText("time") || !isText("event")) return std::nullopt;
  return event;
}

/// Empty when it has no such field, or none that is text.
std::string textIn(const Json& event, const char* field) {
  const auto found = event.find(field);
  return found != event.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// Clocks count nanoseconds, and end in 2262.
constexpr std::chrono::years longest{100};

/// "90s", "15m", "2h", "7d"; nothing: it is none of that.
std::optional<std::chrono::seconds> durationOf(std::string_view text) {
  if (text.empty()) return std::nullopt;
  std::int64_t unit = 0;
  switch (text.back()) {
    case 's': unit = 1; break;
    case 'm': unit = 60; break;
    case 'h': unit = 3600; break;
    case 'd': unit = 24 * 3600; break;
    default: return std::nullopt;
  }
  std::uint32_t count = 0;
  const char* const end = text.data() + text.size() - 1;
  if (std::from_chars(text.data(), end, count).ptr != end || end == text.data())
    return std::nullopt;
  const std::chrono::seconds duration(unit * count);
  return duration < longest ? std::optional(duration) : std::nullopt;
}

std::optional<std::chrono::system_clock::time_point> dateOf(const std::string& text) {
  for (const char* format : {"%Y-%m-%dT%H:%M:%SZ", "%Y-%m-%dT%H:%M:%S", "%Y-%m-%dT%H:%M",
                             "%Y-%m-%d %H:%M:%S", "%Y-%m-%d %H:%M", "%Y-%m-%d"}) {
    std::tm date{};
    const char* const end = strptime(text.c_str(), format, &date);
    if (end == nullptr || *end != '\0') continue;
    const std::chrono::seconds since_1970(timegm(&date));
    if (since_1970 < std::chrono::seconds(0) || since_1970 > 2 * longest) return std::nullopt;
    return std::chrono::system_clock::time_point(since_1970);
  }
  return std::nullopt;
}

}  // namespace

bool EventFilter::takes(std::string_view line) const {
  const auto event = parsedEvent(line);
  if (!event) return false;
  const auto is = [&](const char* field, const std::string& wanted) {
    return wanted.empty() || textIn(*event, field) == wanted;
  };
  return (events.empty() || events.contains(textIn(*event, "event"))) && is("space", space) &&
         is("cause", cause) && textIn(*event, "worker").starts_with(worker) &&
         textIn(*event, "time") >= since;
}

std::string sinceText(const std::string& text, std::chrono::system_clock::time_point now) {
  if (const auto duration = durationOf(text)) return utcText(now - *duration);
  if (const auto date = dateOf(text)) return utcText(*date);
  throw badInput(
      "\"{}\" is no time: a date and time of day in UTC (2026-11-24T20:15:30Z, 2026-11-24), or how "
      "long ago (90s, 15m, 2h, 7d)",
      text);
}

std::string textOfEvent(std::string_view line) {
  const auto event = parsedEvent(line);
  if (!event) return "";
  std::string time = textIn(*event, "time");
  if (time.size() > 11) time = time.substr(0, 10) + ' ' + time.substr(11, time.size() - 12);
  std::string fields;
  for (const auto& [field, value] : event->items()) {
    if (field == "time" || field == "event") continue;
    fields += fmt::format("{}{} {}", fields.empty() ? "" : ", ", field,
                          value.is_string() ? value.get<std::string>() : value.dump());
  }
  return fmt::format("{} {:<14} {}", time, textIn(*event, "event"), fields);
}

std::vector<std::string> lastEvents(const std::filesystem::path& directory,
                                    const EventFilter& filter, std::size_t most) {
  std::vector<std::string> found;  // the latest first
  const std::vector<std::uint32_t> numbers = eventFiles(directory);
  for (auto number = numbers.rbegin(); number != numbers.rend() && found.size() < most; ++number) {
    std::ifstream file(eventFile(directory, *number), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    // Behind the last line feed there is half a line, or none.
    for (std::size_t end = text.rfind('\n'); end != std::string::npos && found.size() < most;) {
      const std::size_t before = end == 0 ? std::string::npos : text.rfind('\n', end - 1);
      const std::size_t begin = before == std::string::npos ? 0 : before + 1;
      const std::string_view line = std::string_view(text).substr(begin, end - begin);
      if (filter.takes(line)) found.emplace_back(line);
      end = before;
    }
  }
  std::ranges::reverse(found);
  return found;
}

void EventReader::readOn(const std::function<void(std::string_view line)>& take) {
  // Those that are removed meanwhile are gone.
  for (const std::uint32_t number : eventFiles(directory_)) {
    if (number < number_) continue;
    if (number > number_) offset_ = 0;
    number_ = number;
    readFile(take);
  }
}

void EventReader::readFile(const std::function<void(std::string_view line)>& take) {
  const std::filesystem::path path = eventFile(directory_, number_);
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    if (!std::filesystem::exists(path)) return;
    throw failure("{}: cannot be read: {}", path.string(), errnoText());
  }
  file.seekg(static_cast<std::streamoff>(offset_));
  // At the end of the file there is half a line, or none.
  for (std::string line; std::getline(file, line) && !file.eof();) {
    offset_ += line.size() + 1;
    take(line);
  }
}

}  // namespace palpate
