#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Which events are wanted, by event_words; empty: all.
using WantedEvents = std::set<std::string>;

/// The last `most` that are wanted, the latest last. Reads no more files than it needs.
std::vector<std::string> lastEvents(const std::filesystem::path& directory,
                                    const WantedEvents& wanted, std::size_t most);

/// Reads the events of a state directory from the oldest on, whoever writes there meanwhile. One
/// thread.
class EventReader {
 public:
  /// A directory without any is one in which nothing happened.
  explicit EventReader(std::filesystem::path directory, WantedEvents wanted = {})
      : directory_(std::move(directory)), wanted_(std::move(wanted)) {}

  /// Gives those behind the ones that were given before, in order, without line feeds. Passes over
  /// lines that are no events. Error when a file is there and cannot be read.
  void readOn(const std::function<void(std::string_view line)>& take);

 private:
  std::filesystem::path directory_;
  WantedEvents wanted_;
  std::uint32_t number_ = 0;  ///< of the file that is read; 0: none yet
  std::uint64_t offset_ = 0;  ///< behind the last line feed
};

}  // namespace palpate
