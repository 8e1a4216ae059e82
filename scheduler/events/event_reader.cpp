#include "scheduler/events/event_reader.hpp"

#include <deque>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "scheduler/events/event_log.hpp"

namespace palpate {
namespace {

/// Returns true if `line` is a complete line of Event::line() with a wanted event.
bool isWanted(std::string_view line, const WantedEvents& wanted) {
  constexpr std::string_view first = R"({"time":")", second = R"(","event":")";
  const std::size_t at = line.find(second);
  if (!line.starts_with(first) || at == std::string_view::npos) return false;
  const std::string_view rest = line.substr(at + second.size());
  return (wanted.empty() || wanted.contains(std::string(rest.substr(0, rest.find('"'))))) &&
         nlohmann::json::accept(line);
}

/// Calls `take` for each wanted line that begins at or after `offset` in a file. Returns the offset
/// after the last line feed. A file that was removed meanwhile counts as empty.
std::uint64_t readLines(const std::filesystem::path& path, std::uint64_t offset,
                        const WantedEvents& wanted,
                        const std::function<void(std::string_view line)>& take) {
  std::ifstream file(path, std::ios::binary);
  if (!file && std::filesystem::exists(path))
    throw failure("{}: cannot read: {}", path.string(), errnoText());
  file.seekg(static_cast<std::streamoff>(offset));
  // Skip a partial line at the end of the file.
  for (std::string line; std::getline(file, line) && !file.eof();) {
    offset += line.size() + 1;
    if (isWanted(line, wanted)) take(line);
  }
  return offset;
}

}  // namespace

std::vector<std::string> lastEvents(const std::filesystem::path& directory,
                                    const WantedEvents& wanted, std::size_t most) {
  std::vector<std::string> found;
  const std::vector<std::uint32_t> numbers = eventFiles(directory);
  for (auto number = numbers.rbegin(); number != numbers.rend() && found.size() < most; ++number) {
    std::deque<std::string> earlier;
    readLines(eventFile(directory, *number), 0, wanted, [&](std::string_view line) {
      earlier.emplace_back(line);
      if (earlier.size() > most - found.size()) earlier.pop_front();
    });
    found.insert(found.begin(), earlier.begin(), earlier.end());
  }
  return found;
}

void EventReader::readOn(const std::function<void(std::string_view line)>& take) {
  for (const std::uint32_t number : eventFiles(directory_)) {
    if (number < number_) continue;
    if (number > number_) offset_ = 0;
    number_ = number;
    offset_ = readLines(eventFile(directory_, number), offset_, wanted_, take);
  }
}

}  // namespace palpate
