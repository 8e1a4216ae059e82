#include "scheduler/progress.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <string>

#include "scheduler/status.hpp"

namespace palpate {
namespace {

constexpr std::chrono::milliseconds redraw_every{200};
constexpr std::chrono::seconds line_every{5};
constexpr std::size_t bar_width = 28;

std::string barOf(const wire::Status& status) {
  std::int64_t points = 0, known = 0;
  for (const wire::SpaceStatus& space : status.spaces()) {
    points += space.points();
    known += space.points() - space.unknown();
  }
  const std::size_t filled =
      points > 0 ? bar_width * static_cast<std::size_t>(known) / static_cast<std::size_t>(points)
                 : 0;
  return '[' + std::string(filled, '#') + std::string(bar_width - filled, ' ') + ']';
}

}  // namespace

Progress::Progress()
    : wanted_(spdlog::get_level() <= spdlog::level::info),
      terminal_(isatty(STDERR_FILENO) == 1),
      next_(std::chrono::steady_clock::now()) {
  // Log lines would tear the bar apart.
  if (wanted_ && terminal_ && spdlog::get_level() == spdlog::level::info)
    spdlog::set_level(spdlog::level::warn);
}

void Progress::show(const Coordinator& coordinator) {
  const auto now = std::chrono::steady_clock::now();
  if (!wanted_ || now < next_) return;
  next_ = now + (terminal_ ? std::chrono::milliseconds(redraw_every)
                           : std::chrono::milliseconds(line_every));
  const wire::Status status = coordinator.status(now);
  if (terminal_)
    fmt::print(stderr, "\r{} {}\x1b[K", barOf(status), progressLine(status));
  else
    fmt::print(stderr, "{}\n", progressLine(status));
  drawn_ = terminal_;
}

void Progress::end() {
  if (drawn_) fmt::print(stderr, "\n");
  drawn_ = false;
}

}  // namespace palpate
