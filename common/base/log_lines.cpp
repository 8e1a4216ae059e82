#include "common/base/log_lines.hpp"

#include <fmt/chrono.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <utility>

namespace palpate {
namespace {

class JsonLines : public spdlog::formatter {
 public:
  JsonLines(std::string program, std::string verb)
      : program_(std::move(program)), verb_(std::move(verb)) {}

  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
    const auto level = spdlog::level::to_string_view(message.level);
    const nlohmann::ordered_json object = {
        {"time", utcText(message.time)},
        {"level", std::string(level.data(), level.size())},
        {"program", program_},
        {"verb", verb_},
        {"pid", getpid()},
        {"message", std::string(message.payload.data(), message.payload.size())}};
    const std::string text =
        object.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
    line.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<spdlog::formatter> clone() const override {
    return std::make_unique<JsonLines>(program_, verb_);
  }

 private:
  std::string program_, verb_;
};

}  // namespace

std::unique_ptr<spdlog::formatter> jsonLines(std::string program, std::string verb) {
  return std::make_unique<JsonLines>(std::move(program), std::move(verb));
}

std::string utcText(std::chrono::system_clock::time_point when) {
  const auto milliseconds = std::chrono::floor<std::chrono::milliseconds>(when.time_since_epoch());
  const auto seconds = std::chrono::floor<std::chrono::seconds>(milliseconds);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z",
                     fmt::gmtime(static_cast<std::time_t>(seconds.count())),
                     (milliseconds - seconds).count());
}

}  // namespace palpate
