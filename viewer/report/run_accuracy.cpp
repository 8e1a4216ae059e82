#include "viewer/report/run_accuracy.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <sstream>

#include "common/base/error.hpp"
#include "common/base/foreign_program.hpp"
#include "common/base/index.hpp"
#include "common/base/program.hpp"
#include "common/mesh/surface_point.hpp"
#include "common/problem/problem.hpp"
#include "viewer/haptics/recording.hpp"

namespace palpate {
namespace {

constexpr std::size_t most_compared = 1000;
constexpr std::size_t time_intervals = 10;
/// The live solver has found its first equilibria after this time in a contact, s.
constexpr double contact_beginning = 0.3;
/// The speed of the tool is its mean over this time, s.
constexpr double speed_time = 0.02;
constexpr double speed_ends[] = {0.005, 0.01, 0.02, 0.05, 0.1, 0.2};  // m/s
constexpr std::chrono::hours solve_patience{2};

/// Largest distance of a recorded anchor from its body, m: of rounding.
constexpr double on_surface = 1e-9;

bool isFinite(const RecordedTouch& touch) {
  return touch.anchor.allFinite() && touch.displacement.allFinite() && touch.force.allFinite();
}

/// Returns the speed of the tool around tick n, m/s.
double speedAt(const std::vector<RecordedTouch>& touches, std::size_t n) {
  std::size_t first = n, last = n;
  const auto isNear = [&](std::size_t other) {
    return std::abs(touches[other].time - touches[n].time) <= speed_time / 2;
  };
  while (first > 0 && isNear(first - 1)) --first;
  while (last + 1 < touches.size() && isNear(last + 1)) ++last;
  const double seconds = touches[last].time - touches[first].time;
  return seconds > 0 ? (touches[last].tool - touches[first].tool).norm() / seconds : 0;
}

using Forces = std::vector<std::optional<Eigen::Vector3d>>;

/// Returns the exact forces on the tool `active`, N; no value where there is no solution.
Forces solvedForces(const std::vector<RecordedTouch>& touches, const std::filesystem::path& scene,
                    const std::string& active) {
  std::string lines;
  for (const RecordedTouch& touch : touches)
    lines +=
        fmt::format("{} {}\n", fmt::join(touch.anchor, " "), fmt::join(touch.displacement, " "));
  const Ran solved = runToItsEnd(
      {.words = {programBeside("palpate-worker").string(), "solve", "--quiet", scene.string(),
                 "--active", active, "--at", "-", "--displacement", "-", "--json"},
       .package = "palpate",
       .input = std::move(lines),
       .patience = solve_patience,
       .heeds_interrupts = true});
  Forces forces;
  std::istringstream answers(solved.out);
  for (std::string line; std::getline(answers, line);) {
    const auto answer = nlohmann::json::parse(line);
    forces.emplace_back();
    if (answer.at("converged"))
      forces.back() = Eigen::Vector3d(answer.at("force").get<std::array<double, 3>>().data());
  }
  if (forces.size() != touches.size())
    throw failure("{}: {} of {} touches were solved: {}", scene.string(), forces.size(),
                  touches.size(), solved.err);
  return forces;
}

/// Returns the name of the active node or area whose finger is nearest to a place at rest.
std::string fingerAt(const Problem& problem, const Eigen::Vector3d& place) {
  const auto distance = [&](const ActivePatch& patch) {
    return patch.finger && !patch.probe ? (patch.finger->center - place).norm() : INFINITY;
  };
  const auto nearest = std::ranges::min_element(problem.active, {}, distance);
  const ActiveSelection& active = problem.scene.active[at(nearest - problem.active.begin())];
  return active.area.empty() ? active.name : active.area;
}

/// As solvedForces(), each touch by the finger that is nearest to it.
Forces exactForces(const std::vector<RecordedTouch>& touches, const Problem& problem,
                   const std::filesystem::path& scene) {
  std::map<std::string, std::vector<std::size_t>> fingers;
  for (std::size_t n = 0; n < touches.size(); ++n)
    fingers[fingerAt(problem, touches[n].anchor)].push_back(n);
  Forces exact(touches.size());
  for (const auto& [finger, chosen] : fingers) {
    const Forces solved =
        solvedForces(mapped(chosen, [&](std::size_t n) { return touches[n]; }), scene, finger);
    for (std::size_t n = 0; n < chosen.size(); ++n) exact[chosen[n]] = solved[n];
  }
  return exact;
}

/// Refuses a run that touches another body. Warns if anything else differs from its scene.
void checkScene(const std::filesystem::path& recording, const Recording& run,
                const std::vector<std::size_t>& chosen, const std::filesystem::path& scene,
                const Problem& problem) {
  for (const std::size_t n : chosen) {
    const Eigen::Vector3d& anchor = run.touches[n].anchor;
    const Eigen::Vector3d nearest =
        positionOf(problem.mesh, nearestOnSurface(problem.mesh, anchor));
    if (!((nearest - anchor).norm() <= on_surface))
      throw badInput("{}: tick {} touches another body than that of {}; give the scene of this run",
                     recording.string(), n + 1, scene.string());
  }
  if (!run.builds.empty() && std::ranges::find(run.builds, problemId(problem)) == run.builds.end())
    spdlog::warn(
        "{}: {} has changed since this run, or is another scene; if its material, fixed nodes or "
        "fingers differ, the errors include this",
        recording.string(), scene.string());
}

/// Returns the ticks in which one finger touches, at most most_compared of them, evenly spread.
std::vector<std::size_t> chosenTicks(const std::vector<RecordedTouch>& touches) {
  std::vector<std::size_t> touching, chosen;
  for (std::size_t n = 0; n < touches.size(); ++n)
    if (touches[n].touching && !touches[n].held && isFinite(touches[n])) touching.push_back(n);
  const std::size_t count = std::min(touching.size(), most_compared);
  for (std::size_t n = 0; n < count; ++n) chosen.push_back(touching[n * touching.size() / count]);
  return chosen;
}

/// Measures the ticks in the intervals that end at `ends` and at infinity.
std::vector<RunInterval> measureIntervals(const RunAccuracy& run, std::span<const double> ends,
                                          double ComparedTick::*value) {
  std::vector<RunInterval> intervals;
  double from = 0;
  for (std::size_t n = 0; n <= ends.size(); ++n) {
    const double to = n < ends.size() ? ends[n] : INFINITY;
    std::vector<ForceComparison> inside;
    for (const ComparedTick& tick : run.compared)
      if (from <= tick.*value && tick.*value < to) inside.push_back(tick.force);
    if (!inside.empty()) intervals.push_back({from, to, measureErrors(inside, run.target)});
    from = to;
  }
  return intervals;
}

}  // namespace

RunAccuracy measureRun(const std::filesystem::path& recording, const std::filesystem::path& scene) {
  const Scene read = readScene(scene);
  const Recording recorded = readRecording(recording);
  const std::vector<RecordedTouch>& touches = recorded.touches;
  RunAccuracy run;
  run.recording = recording;
  run.scene = read.name;
  run.ticks = touches.size();
  if (read.accuracy.adaptive()) run.target = {read.accuracy.force_error, read.accuracy.force_floor};
  std::vector<double> contact_began(touches.size());
  for (std::size_t n = 0; n < touches.size(); ++n) {
    run.touching += touches[n].touching;
    run.held += touches[n].touching && touches[n].held;
    const bool goes_on = n > 0 && touches[n - 1].touching;
    contact_began[n] = goes_on ? contact_began[n - 1] : touches[n].time;
  }
  const std::vector<std::size_t> chosen = chosenTicks(touches);
  if (chosen.empty())
    throw badInput("{}: nothing was touched by one finger alone in this run", recording.string());
  const Problem problem = loadProblem(scene);
  checkScene(recording, recorded, chosen, scene, problem);
  const Forces exact =
      exactForces(mapped(chosen, [&](std::size_t n) { return touches[n]; }), problem, scene);
  std::vector<ForceComparison> all;
  for (std::size_t c = 0; c < chosen.size(); ++c) {
    const RecordedTouch& touch = touches[chosen[c]];
    run.unsolved += !exact[c];
    if (!exact[c]) continue;
    all.push_back({*exact[c], touch.force, touch.error_bound, true});
    run.compared.push_back({touch.time, touch.time - contact_began[chosen[c]],
                            speedAt(touches, chosen[c]), all.back()});
  }
  run.all = measureErrors(all, run.target);
  std::vector<double> ends;
  for (std::size_t n = 1; n < time_intervals; ++n)
    ends.push_back(touches.back().time * static_cast<double>(n) / time_intervals);
  run.times = measureIntervals(run, ends, &ComparedTick::time);
  if (!run.times.empty()) run.times.back().to = touches.back().time;
  run.in_contact = measureIntervals(run, std::array{contact_beginning}, &ComparedTick::in_contact);
  run.speeds = measureIntervals(run, speed_ends, &ComparedTick::speed);
  return run;
}

}  // namespace palpate
