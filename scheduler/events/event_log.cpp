#include "scheduler/events/event_log.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/log_lines.hpp"
#include "common/base/number_in.hpp"

namespace palpate {
namespace {

constexpr std::string_view event_file_prefix = "events-", event_file_suffix = ".jsonl";
/// Limit on the bytes that wait for a flush(), however long a turn lasts.
constexpr std::size_t most_waiting = 64 << 10;

}  // namespace

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

std::filesystem::path eventFile(const std::filesystem::path& directory, std::uint32_t number) {
  return directory / fmt::format("{}{:06}{}", event_file_prefix, number, event_file_suffix);
}

std::vector<std::uint32_t> eventFiles(const std::filesystem::path& directory) {
  std::vector<std::uint32_t> numbers;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(directory, error), end; !error && entry != end;
       entry.increment(error))
    if (const auto number = numberBetween<std::uint32_t>(
            event_file_prefix, entry->path().filename().string(), event_file_suffix))
      numbers.push_back(*number);
  std::ranges::sort(numbers);
  return numbers;
}

EventLog::EventLog(std::filesystem::path directory, std::uint64_t file_bytes,
                   std::uint32_t most_files)
    : directory_(std::move(directory)), file_bytes_(file_bytes), most_files_(most_files) {}

void EventLog::add(const Event& event) {
  const auto now = std::chrono::system_clock::now();
  if (lost_ > 0 && waiting_.empty())
    waiting_ = Event("left_out").with("events", lost_).line(now) + '\n';
  const std::string line = event.line(now);
  PALPATE_ASSERT(line.find('\n') == std::string::npos, "an event must be a single line");
  waiting_ += line + '\n';
  ++lines_;
  if (waiting_.size() >= most_waiting) flush();
}

void EventLog::flush() {
  if (waiting_.empty()) return;
  if ((file_ || open()) && (written_ < file_bytes_ || beginFile(number_ + 1)) && writeWaiting()) {
    lost_ = 0;
    told_ = false;
  } else {
    lose(errnoText());
  }
  waiting_.clear();
  lines_ = 0;
}

/// Opens the last existing file to append to it.
bool EventLog::open() {
  const std::vector<std::uint32_t> numbers = eventFiles(directory_);
  return beginFile(numbers.empty() ? 1 : numbers.back());
}

bool EventLog::beginFile(std::uint32_t number) {
  FileDescriptor file(
      ::open(eventFile(directory_, number).c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0600));
  struct stat info {};
  if (!file || fstat(file.get(), &info) != 0) return false;
  file_ = std::move(file);
  number_ = number;
  written_ = static_cast<std::uint64_t>(info.st_size);
  char last = '\n';
  half_line_ =
      written_ > 0 && (pread(file_.get(), &last, 1, info.st_size - 1) != 1 || last != '\n');
  prune();
  return true;
}

void EventLog::prune() const {
  for (const std::uint32_t number : eventFiles(directory_)) {
    if (number + most_files_ > number_) return;
    std::error_code left_there;
    std::filesystem::remove(eventFile(directory_, number), left_there);
  }
}

/// Writes the waiting lines to the open file, after completing a partial line there.
bool EventLog::writeWaiting() {
  if (half_line_) waiting_.insert(0, 1, '\n');
  for (std::string_view rest = waiting_; !rest.empty();) {
    const ssize_t bytes = write(file_.get(), rest.data(), rest.size());
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes <= 0) return false;
    written_ += static_cast<std::uint64_t>(bytes);
    rest.remove_prefix(static_cast<std::size_t>(bytes));
    half_line_ = !rest.empty();
  }
  return true;
}

void EventLog::lose(const std::string& why) {
  lost_ += lines_;
  if (std::exchange(told_, true)) return;
  spdlog::warn("{}: cannot write events ({}); the build continues without them",
               directory_.string(), why);
}

}  // namespace palpate
