#include "scheduler/events/event_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/error.hpp"
#include "scheduler/events/event_log.hpp"

namespace palpate {
namespace {

using EventJson = nlohmann::ordered_json;

/// Nothing: the line is no event.
std::optional<EventJson> parsedEvent(std::string_view line) {
  // Of an event are objects, and lists of numbers in them; to write more out would need a stack.
  constexpr int deepest = 8;
  const auto isShallow = [](int depth, EventJson::parse_event_t, EventJson&) {
    return depth < deepest;
  };
  EventJson event = EventJson::parse(line, isShallow, false);
  const auto isText = [&](const char* field) {
    const auto found = event.find(field);
    return found != event.end() && found->is_string();
  };
  if (!event.is_object() || !isText("time") || !isText("event")) return std::nullopt;
  return event;
}

bool isWanted(std::string_view line, const WantedEvents& wanted) {
  const auto event = parsedEvent(line);
  return event && (wanted.empty() || wanted.contains(event->at("event").get<std::string>()));
}

}  // namespace

std::string textOfEvent(std::string_view line) {
  const auto event = parsedEvent(line);
  if (!event) return "";
  std::string time = event->at("time");
  if (time.size() > 11) time = time.substr(0, 10) + ' ' + time.substr(11, time.size() - 12);
  std::string fields;
  for (const auto& [field, value] : event->items()) {
    if (field == "time" || field == "event") continue;
    fields += fmt::format("{}{} {}", fields.empty() ? "" : ", ", field,
                          value.is_string() ? value.get<std::string>() : value.dump());
  }
  return fmt::format("{} {:<14} {}", time, event->at("event").get<std::string>(), fields);
}

std::vector<std::string> lastEvents(const std::filesystem::path& directory,
                                    const WantedEvents& wanted, std::size_t most) {
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
      if (isWanted(line, wanted)) found.emplace_back(line);
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
    if (isWanted(line, wanted_)) take(line);
  }
}

}  // namespace palpate
