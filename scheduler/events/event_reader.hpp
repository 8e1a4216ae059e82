#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Which events are wanted: those that fit everything that is not empty.
struct EventFilter {
  std::set<std::string> events = {};   ///< words
  std::string space = {}, cause = {};  ///< the whole of the field
  std::string worker = {};             ///< how the field begins, hexadecimal
  std::string since = {};              ///< utcText of a time

  /// False for what is no event too: half a line, or not JSON.
  bool takes(std::string_view line) const;
};

/// The time that `text` means, for EventFilter::since: a date, or a date and a time of day in UTC
/// ("2026-11-24", "2026-11-24T20:15", "2026-11-24T20:15:30Z"), or how long before `now` ("90s",
/// "15m", "2h", "7d"). Error (bad input) when it is none of that.
std::string sinceText(const std::string& text, std::chrono::system_clock::time_point now);

/// The event for people: "2026-11-24 20:17:59.123 worker_lost worker 0a1b2c3d, host node7, ...".
/// Empty for what is no event.
std::string textOfEvent(std::string_view line);

/// The last `most` that a filter takes, the latest last. Reads no more than it needs.
std::vector<std::string> lastEvents(const std::filesystem::path& directory,
                                    const EventFilter& filter, std::size_t most);

/// Reads the events of a state directory from the oldest on, whoever writes there meanwhile. One
/// thread.
class EventReader {
 public:
  /// A directory without any is one in which nothing happened.
  explicit EventReader(std::filesystem::path directory) : directory_(std::move(directory)) {}

  /// Gives the whole lines behind those that were given before, in order, without line feeds; they
  /// need not be events. Error when a file is there and cannot be read.
  void readOn(const std::function<void(std::string_view line)>& take);

 private:
  /// Of the file `number_`, from `offset_` on.
  void readFile(const std::function<void(std::string_view line)>& take);

  std::filesystem::path directory_;
  std::uint32_t number_ = 0;  ///< of the file that is read; 0: none yet
  std::uint64_t offset_ = 0;  ///< behind the last line feed
};

}  // namespace palpate
