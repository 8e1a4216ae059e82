#include "scheduler/verbs/status_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/assertion.hpp"
#include "common/base/number_text.hpp"
#include "scheduler/plan/refinement.hpp"
#include "scheduler/service/status.hpp"

namespace palpate {
namespace {

constexpr std::size_t longest_bar = 28, shortest_bar = 8;

/// Returns the text for the time left; empty if there is no estimate.
std::string timeLeft(const wire::Status& status, const wire::SpaceStatus& all) {
  if (status.paused()) return "paused";
  // Every point is solved or has failed, but some are still solved again from other neighbours. The
  // number of these solves is unknown.
  if (all.unknown() == 0 && status.state() == "running") return "solving branches";
  if (!status.has_eta_seconds()) return "";
  // Unfinished work never takes 0 s.
  return (status.may_grow() ? "about " : "") + durationText(std::max(1.0, status.eta_seconds())) +
         " left";
}

/// Selects the spaces to show. If there are more than 24, selects the first 24 that are in progress
/// or have failed points, and adds a sum. Spaces in progress come first, then the spaces with most
/// failed points.
std::vector<wire::SpaceStatus> spacesToShow(const wire::Status& status) {
  constexpr std::size_t most = 24;
  std::vector<wire::SpaceStatus> spaces(status.spaces().begin(), status.spaces().end());
  if (spaces.size() <= most) return spaces;
  const auto done = [](const wire::SpaceStatus& s) { return s.stage() == "complete"; };
  wire::SpaceStatus sum = sumOf(status);
  sum.set_name(fmt::format("all {}", spaces.size()));
  sum.set_stage(fmt::format("{} complete", std::ranges::count_if(spaces, done)));
  std::erase_if(spaces, [&](const wire::SpaceStatus& s) {
    return done(s) ? s.failed() == 0 : s.expandable() == 0;
  });
  std::ranges::stable_sort(spaces, {},
                           [&](const auto& s) { return std::pair(done(s), -s.failed()); });
  if (spaces.size() > most) spaces.resize(most);
  spaces.push_back(sum);
  return spaces;
}

/// Formats the points of the spaces from spacesToShow() by tag, one row per space. `with_stages`
/// adds a column with the stage of each space.
std::string pointTable(const wire::Status& status, bool with_stages) {
  const auto row = [&](const auto&... cells) {
    return fmt::format(fmt::runtime(with_stages ? "{:<16} {:>8} {:>10} {:>11} {:>8} {:>8}  {}\n"
                                                : "{:<16} {:>8} {:>10} {:>11} {:>8} {:>8}\n"),
                       cells...);
  };
  std::string text =
      row("active node", "points", "expandable", "terminating", "failed", "unknown", "stage");
  for (const wire::SpaceStatus& s : spacesToShow(status))
    text += row(s.name(), s.points(), s.expandable(), s.terminating(), s.failed(), s.unknown(),
                s.stage());
  return text;
}

/// Formats counts as "1 step_budget, 11 unreachable", sorted by word.
std::string countsText(const std::map<std::string, std::int32_t>& counts) {
  std::vector<std::string> parts;
  for (const auto& [word, count] : counts) parts.push_back(fmt::format("{} {}", count, word));
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// Formats "TITLE: 1 step_budget, 11 unreachable" and a line feed; empty if there are no causes.
std::string causesLine(const char* title,
                       const google::protobuf::Map<std::string, std::int32_t>& causes) {
  if (causes.empty()) return "";
  return fmt::format("{}: {}\n", title, countsText({causes.begin(), causes.end()}));
}

/// Formats "excluded: machine node7, key 0a1b2c3d4e5f: REASON" and a line feed.
std::string keptOutLine(const wire::KeptOut& who) {
  std::string text = fmt::format("excluded: {}", who.kind());
  if (!who.worker().empty()) text += fmt::format(" {} on", who.worker().substr(0, 8));
  if (!who.host().empty()) text += " " + who.host();
  if (!who.key().empty())
    text += fmt::format("{} {}", who.host().empty() ? "" : ", key", who.key().substr(0, 12));
  return fmt::format("{}: {}\n", text, who.reason());
}

std::string probesOf(const SpaceRowsList& spaces) {
  wire::Status status;
  wire::SpaceStatus unsolved;
  ProbeCounts counts;
  for (const auto& space : spaces)
    for (std::int32_t n = 0; n < space->probes(); ++n) {
      const PointRecord record = space->probe(n).record;
      counts.add(record);
      if (record.tag == Tag::failed && !isBeyondForce(record)) addPoint(status, unsolved, record);
    }
  if (counts.all == 0) return "";
  return fmt::format("probes: {}, {} within max_force, {} beyond it, {} not solved\n", counts.all,
                     counts.within_force, counts.beyond_force, counts.unsolved()) +
         causesLine("probes not solved", status.failed_points());
}

std::string accuracyOf(const SpaceRowsList& spaces, const Scene& scene) {
  if (!scene.accuracy.adaptive()) return "";
  double least = 1, kept = 0;
  std::size_t judged = 0, keeping = 0;
  std::string least_name;
  for (const auto& space : spaces) {
    if (space->patch().probe) continue;
    // A failed origin allows neither refinement nor an error estimate.
    if (!isSolved(space->tag(0))) continue;
    const Refinement state = nextRefinement(tableOf(*space), scene);
    PALPATE_ASSERT(state.kept >= 0 && state.kept <= 1, "the share must be 0 to 1");
    ++judged;
    keeping += state.kept == 1;
    kept += state.kept;
    if (state.kept < least) least_name = space->patch().name;
    least = std::min(least, state.kept);
  }
  if (judged == 0) return "";
  std::string text = fmt::format(
      "accuracy: the estimated error is below max({:g} %, {:g} N) in {:.4g} % of the workspace",
      100 * scene.accuracy.force_error, scene.accuracy.force_floor,
      100 * kept / static_cast<double>(judged));
  if (keeping < judged)
    text += fmt::format(
        "; {} of {} meet this in the whole workspace, and the worst, {}, in {:.4g} %. A "
        "larger value of `levels` helps where cells have already been split `levels` times, but "
        "not at a jump between branches",
        keeping, counted(judged, "active node"), least_name, 100 * least);
  return text + '\n';
}

/// Formats "priority: tip 3, dome -1"; empty if all priorities are 0.
std::string prioritiesLine(const wire::Status& status) {
  std::vector<std::string> parts;
  for (const wire::SpaceStatus& row : status.spaces())
    if (row.priority() != 0) parts.push_back(fmt::format("{} {}", row.name(), row.priority()));
  return parts.empty() ? "" : fmt::format("priority: {}\n", fmt::join(parts, ", "));
}

/// Lists the workers one by one if there are few; otherwise counts them by machine.
std::string workersOf(const wire::Status& status) {
  constexpr int most_lines = 8;
  std::string text;
  if (status.workers_size() <= most_lines) {
    for (const wire::WorkerStatus& w : status.workers())
      text += fmt::format("worker {} on {}: {}, {} results, heard {:.0f} s ago\n", w.pid(),
                          w.host(), w.state(), w.results(), w.heard_seconds_ago());
    return text;
  }
  struct Machine {
    std::map<std::string, std::int32_t> workers;  // number of workers in each state
    std::int64_t results = 0;
  };
  std::map<std::string, Machine> machines;
  for (const wire::WorkerStatus& w : status.workers()) {
    ++machines[w.host()].workers[w.state()];
    machines[w.host()].results += w.results();
  }
  for (const auto& [host, machine] : machines)
    text += fmt::format("workers on {}: {}; {} results\n", host, countsText(machine.workers),
                        machine.results);
  return text;
}

/// Returns a line "COUNTER: COUNT" for each alarming counter above 0.
std::string alarmsOf(const wire::Status& status) {
  std::string text;
  for (const char* alarm : {"divergent_results", "bad_messages", "lost_workers", "refused_workers",
                            "unchecked_results", "closed_connections"})
    if (const auto found = status.counters().find(alarm);
        found != status.counters().end() && found->second > 0)
      text += fmt::format("{}: {}\n", alarm, found->second);
  return text;
}

}  // namespace

std::string durationText(double seconds) {
  const auto s = static_cast<std::int64_t>(std::llround(seconds));
  if (s < 120) return fmt::format("{} s", s);
  if (s < 7200) return fmt::format("{} min", (s + 30) / 60);
  return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

std::string progressLine(const wire::Status& status, std::size_t columns) {
  const wire::SpaceStatus all = sumOf(status);
  std::string line = fmt::format("{}/{} points", all.points() - all.unknown(), all.points());
  // The most wanted parts come first, because the last ones are dropped if the line is too long.
  for (const std::string& part :
       {timeLeft(status, all), fmt::format("{:.1f}/s", status.configurations_per_second()),
        counted(status.workers_size(), "worker"), fmt::format("{} ready", status.ready())}) {
    if (part.empty()) continue;
    if (line.size() + 2 + part.size() > columns) break;
    line += ", " + part;
  }
  return line;
}

std::string pointText(const LatticePoint& p, std::int32_t divisions) {
  return fmt::format("({})", vectorText(Eigen::Vector3d(p[0], p[1], p[2]) / divisions, 6));
}

std::string progressBar(const wire::Status& status, std::size_t columns) {
  const std::size_t brackets = 3;  // "[", "]" and a space
  const std::size_t room = std::max<std::size_t>(columns, 1) - 1;
  const bool with_bar = room >= 2 * (shortest_bar + brackets);
  const std::string line = progressLine(status, with_bar ? room - shortest_bar - brackets : room);
  if (!with_bar || line.size() + shortest_bar + brackets > room) return line.substr(0, room);
  const std::size_t length = std::min(longest_bar, room - line.size() - brackets);
  const wire::SpaceStatus all = sumOf(status);
  const std::int64_t known = all.points() - all.unknown();
  const auto filled = all.points() > 0 ? length * static_cast<std::size_t>(known) /
                                             static_cast<std::size_t>(all.points())
                                       : 0;
  return fmt::format("[{:#<{}}{:{}}] {}", "", filled, "", length - filled, line);
}

std::string summaryOf(const SpaceRowsList& spaces, const Scene& scene, bool partial) {
  wire::Status status;
  for (const auto& space : spaces) {
    if (space->patch().probe) continue;  // reported by probesOf()
    wire::SpaceStatus& row = *status.add_spaces();
    row.set_name(space->patch().name);
    row.set_stage(std::string(name(Stage::complete)));
    for (std::int32_t n = 0; n < space->points(); ++n) addPoint(status, row, space->point(n));
  }
  std::string text = pointTable(status, false) + causesLine("failed", status.failed_points());
  if (!partial) text += probesOf(spaces) + accuracyOf(spaces, scene);
  return text;
}

std::string describe(const wire::Status& status) {
  std::string text =
      fmt::format("scene {}, build {}: {}{}\n\n", status.scene(), status.build().substr(0, 12),
                  status.state(), status.paused() ? ", paused (palpate resume continues it)" : "");
  // The most important lines come first, in case the window is short.
  if (status.state() == "running" || status.state() == "stopping")
    text += progressLine(status) + "\n\n";
  text += pointTable(status, true) + '\n' + prioritiesLine(status);
  text += causesLine("failed points", status.failed_points()) +
          causesLine("failed transitions", status.failed_attempts());
  if (const auto aside = status.set_aside(); aside > 0)
    text += fmt::format("set aside: {} on which workers died; see palpate retry\n",
                        counted(aside, "transition"));
  if (const auto disputed = status.disputed(); disputed > 0)
    text += fmt::format("disputed: {} about which workers disagree\n", counted(disputed, "result"));
  for (const wire::KeptOut& k : status.kept_out()) text += keptOutLine(k);
  return text + alarmsOf(status) + workersOf(status);
}

}  // namespace palpate
