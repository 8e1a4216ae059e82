#include "scheduler/status_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace palpate {
namespace {

constexpr std::size_t longest_bar = 28, shortest_bar = 8;

struct Points {
  std::int64_t all = 0, known = 0;
};

Points pointsOf(const wire::Status& status) {
  Points points;
  for (const wire::SpaceStatus& space : status.spaces()) {
    points.all += space.points();
    points.known += space.points() - space.unknown();
  }
  return points;
}

/// Nothing while nothing can be said.
std::string timeLeft(const wire::Status& status, const Points& points) {
  // Every point has a configuration, and some are solved again from other neighbours: nobody knows
  // how often.
  if (points.known == points.all && status.state() == "running") return "solving branches";
  if (!status.has_eta_seconds()) return "";
  // Nothing takes 0 s as long as it is not done.
  return durationText(std::max(1.0, status.eta_seconds())) +
         (status.may_grow() ? " or more left" : " left");
}

/// Of many spaces those that tell something, as far as they fit on a screen, and a sum: first those
/// that are being worked on, then those with most failed points.
std::vector<wire::SpaceStatus> spacesToShow(std::vector<wire::SpaceStatus> spaces) {
  constexpr std::size_t most = 24;
  if (spaces.size() <= most) return spaces;
  const auto done = [](const wire::SpaceStatus& s) { return s.stage() == "complete"; };
  wire::SpaceStatus sum;
  for (const wire::SpaceStatus& s : spaces) {
    sum.set_points(sum.points() + s.points());
    sum.set_unknown(sum.unknown() + s.unknown());
    sum.set_expandable(sum.expandable() + s.expandable());
    sum.set_terminating(sum.terminating() + s.terminating());
    sum.set_failed(sum.failed() + s.failed());
  }
  sum.set_name(fmt::format("all {}", spaces.size()));
  sum.set_stage(fmt::format("{} complete", std::count_if(spaces.begin(), spaces.end(), done)));
  std::erase_if(spaces, [&](const wire::SpaceStatus& s) {
    return done(s) ? s.failed() == 0 : s.expandable() == 0;
  });
  std::stable_sort(spaces.begin(), spaces.end(), [&](const auto& a, const auto& b) {
    return std::pair(done(a), -a.failed()) < std::pair(done(b), -b.failed());
  });
  if (spaces.size() > most) spaces.resize(most);
  spaces.push_back(sum);
  return spaces;
}

}  // namespace

std::string durationText(double seconds) {
  const auto s = static_cast<std::int64_t>(std::llround(seconds));
  if (s < 120) return fmt::format("{} s", s);
  if (s < 7200) return fmt::format("{} min", (s + 30) / 60);
  return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

std::string progressLine(const wire::Status& status, std::size_t columns) {
  const Points points = pointsOf(status);
  std::string line = fmt::format("{}/{} points", points.known, points.all);
  // What people look for first, first: the last ones go when the line is too long.
  for (const std::string& part :
       {timeLeft(status, points), fmt::format("{:.1f}/s", status.configurations_per_second()),
        fmt::format("{} worker{}", status.workers_size(), status.workers_size() == 1 ? "" : "s"),
        fmt::format("frontier {}", status.ready())}) {
    if (part.empty()) continue;
    if (line.size() + 2 + part.size() > columns) break;
    line += ", " + part;
  }
  return line;
}

std::string progressBar(const wire::Status& status, std::size_t columns) {
  const std::size_t brackets = 3;  // and a space
  const std::size_t room = std::max<std::size_t>(columns, 1) - 1;
  const bool with_bar = room >= 2 * (shortest_bar + brackets);
  const std::string line = progressLine(status, with_bar ? room - shortest_bar - brackets : room);
  if (!with_bar || line.size() + shortest_bar + brackets > room) return line.substr(0, room);
  const std::size_t length = std::min(longest_bar, room - line.size() - brackets);
  const Points points = pointsOf(status);
  const auto filled = static_cast<std::size_t>(
      points.all > 0 ? static_cast<std::int64_t>(length) * points.known / points.all : 0);
  return fmt::format("[{:#<{}}{:{}}] {}", "", filled, "", length - filled, line);
}

std::string pointTable(std::vector<wire::SpaceStatus> spaces, bool with_stages) {
  const auto row = [&](const auto&... cells) {
    return fmt::format(fmt::runtime(with_stages ? "{:<16} {:>8} {:>10} {:>11} {:>8} {:>8}  {}\n"
                                                : "{:<16} {:>8} {:>10} {:>11} {:>8} {:>8}\n"),
                       cells...);
  };
  std::string text =
      row("active node", "points", "expandable", "terminating", "failed", "unknown", "stage");
  for (const wire::SpaceStatus& s : spacesToShow(std::move(spaces)))
    text += row(s.name(), s.points(), s.expandable(), s.terminating(), s.failed(), s.unknown(),
                s.stage());
  return text;
}

std::string causesLine(const char* title, const std::map<std::string, std::int32_t>& causes) {
  std::string text;
  for (const auto& [cause, count] : causes)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, cause);
  return text.empty() ? "" : fmt::format("{}: {}\n", title, text);
}

std::string describe(const wire::Status& status) {
  std::string text = fmt::format("scene {}, build {}: {}\n\n", status.scene(),
                                 status.build().substr(0, 12), status.state());
  text += pointTable({status.spaces().begin(), status.spaces().end()}, true);
  text += '\n';
  if (status.state() == "running" || status.state() == "stopping")
    text += progressLine(status) + '\n';
  const auto& points = status.failed_points();
  text += causesLine("failed points", {points.begin(), points.end()});
  const auto& attempts = status.failed_attempts();
  text += causesLine("failed transitions", {attempts.begin(), attempts.end()});
  for (const wire::WorkerStatus& w : status.workers())
    text += fmt::format("worker {} on {}: {}, {} results, heard {:.0f} s ago\n", w.pid(), w.host(),
                        w.state(), w.results(), w.heard_seconds_ago());
  for (const char* alarm : {"divergent_results", "bad_messages", "lost_workers", "refused_workers"})
    if (const auto found = status.counters().find(alarm);
        found != status.counters().end() && found->second > 0)
      text += fmt::format("{}: {}\n", alarm, found->second);
  return text;
}

}  // namespace palpate
