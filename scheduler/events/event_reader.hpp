#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// The events that a reader wants, as words of event_words. An empty set means all events.
using WantedEvents = std::set<std::string>;

/// Returns the last `most` wanted events, latest last. Reads only the files needed.
std::vector<std::string> lastEvents(const std::filesystem::path& directory,
                                    const WantedEvents& wanted, std::size_t most);

/// Reads the events of a state directory, oldest first, even while a scheduler writes them. One
/// thread.
class EventReader {
 public:
  /// It is no error if the directory has no event files: readOn() then passes no events.
  explicit EventReader(std::filesystem::path directory, WantedEvents wanted = {})
      : directory_(std::move(directory)), wanted_(std::move(wanted)) {}

  /// Passes the events since the last call to `take`, in order, without line feeds. Skips lines
  /// that are not events. Throws Error if a file exists but cannot be read.
  void readOn(const std::function<void(std::string_view line)>& take);

 private:
  std::filesystem::path directory_;
  WantedEvents wanted_;
  std::uint32_t number_ = 0;  ///< number of the current file; 0 if there is none yet
  std::uint64_t offset_ = 0;  ///< position in the current file, after the last line feed
};

}  // namespace palpate
