#include "scheduler/progress.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "scheduler/status_text.hpp"

namespace palpate {
namespace {

constexpr std::chrono::milliseconds redraw_every{200};
/// Into a file: a night of work is a thousand lines.
constexpr std::chrono::milliseconds line_every{30000};

/// Asked anew for every line: windows are resized.
std::size_t columnsOf(int terminal) {
  constexpr std::size_t usual = 80;
  struct winsize size {};
  return ioctl(terminal, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : usual;
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
  next_ = now + (terminal_ ? redraw_every : line_every);
  const wire::Status status = coordinator.status(now);
  if (terminal_)
    fmt::print(stderr, "\r{}\x1b[K", progressBar(status, columnsOf(STDERR_FILENO)));
  else
    fmt::print(stderr, "{}\n", progressLine(status));
  drawn_ = terminal_;
}

void Progress::end() {
  if (drawn_) fmt::print(stderr, "\n");
  drawn_ = false;
}

}  // namespace palpate
