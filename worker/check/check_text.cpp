#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/base/assertion.hpp"
#include "common/base/number_text.hpp"
#include "common/mesh/mesh_text.hpp"
#include "common/problem/problem_warnings.hpp"
#include "common/scene/material_toml.hpp"
#include "worker/check/scene_report.hpp"

namespace palpate {
namespace {

std::string duration(double seconds) {
  if (seconds < 100) return fmt::format("{:.2g} s", seconds);
  if (seconds < 100 * 60) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

template <class... Values>
void say(std::string& text, fmt::format_string<Values...> format, Values&&... values) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
}

/// Writes the scene's lengths in metres, if the scene uses another unit.
void sayConversion(std::string& text, const Scene& scene) {
  if (scene.metres_per_unit == 1) return;
  say(text,
      "unit       1 in the files = {} m; in metres: workspace.radius = {:.6g}, "
      "workspace.spacing = {:.6g}\n",
      scene.metres_per_unit, scene.workspace.radius, scene.workspace.spacing);
  for (const ActiveSelection& active :
       std::span(scene.active).first(std::min(scene.active.size(), listed_names))) {
    const std::string near =
        active.near ? fmt::format("near = {}, ", placeText(*active.near, 4)) : "";
    say(text, "           active \"{}\": {}radius = {:.6g}\n", active.name, near, active.radius);
  }
}

/// Writes the elastic constants at rest, and the mass, of each region.
void sayModuli(std::string& text, const SceneReport& report) {
  const Scene& scene = report.problem->scene;
  for (std::size_t r = 0; r < scene.regions.size(); ++r) {
    const Material& m = scene.regions[r].material;
    const double bulk = bulkModulus(m);
    say(text,
        "at rest    Young's modulus {:.4g} Pa, Poisson's ratio {:.4g}, shear modulus {:.4g} "
        "Pa, bulk modulus {}{}\n",
        youngModulus(m), poissonRatio(m), shearModulus(m),
        std::isinf(bulk) ? "infinite" : fmt::format("{:.4g} Pa", bulk),
        m.density ? fmt::format(", mass {:.3g} kg", *m.density * report.volume_of[r]) : "");
  }
}

void sayBody(std::string& text, const SceneReport& report) {
  const Scene& scene = report.problem->scene;
  PALPATE_ASSERT(report.tetrahedra_in.size() == scene.regions.size(), "each region needs a count");
  for (std::size_t r = 0; r < scene.regions.size(); ++r) {
    const Region& region = scene.regions[r];
    // If the scene assigns no groups, its only region has no name.
    if (scene.regions.size() == 1 && region.isRest())
      say(text, "material   {}\n", inWords(region.material));
    else
      say(text, "material   {} ({}): {}\n",
          region.isRest() ? "rest" : fmt::format("\"{}\"", region.name()),
          counted(report.tetrahedra_in[r], "tetrahedron", "tetrahedra"), inWords(region.material));
  }
  sayModuli(text, report);
  const Discretization& d = scene.discretization;
  say(text, "solved as  displacement {}, pressure {}", word(d.displacement), word(d.pressure));
  if (d.pressure != PressureSpace::none) say(text, ", constraint {}", word(d.constraint));
  say(text, "\n");
  if (!scene.gravity.isZero(0)) say(text, "gravity    {} m/s^2\n", placeText(scene.gravity, 4));
}

void sayActives(std::string& text, const SceneReport& report) {
  const std::size_t n_spaces = report.spaces.size();
  // Somewhat longer lists are shown in full, because "and 1 more" takes a line too.
  const std::size_t shown = n_spaces <= 2 * listed_names ? n_spaces : listed_names;
  for (const SceneReport::Space& space : std::span(report.spaces).first(shown)) {
    const bool finger = space.patch->finger.has_value();
    say(text, "active     \"{}\": {} at {} m, {} of {}, {}\n", space.patch->name,
        finger ? std::string(space.tool) : fmt::format("node {}", space.patch->node),
        placeText(space.place, 4), finger ? "the mean" : fmt::format("{} patch", space.tool),
        counted(space.patch->nodes.size(), "node"), counted(space.unknowns, "unknown"));
  }
  if (shown < n_spaces)
    say(text, "           and {} more, the last is \"{}\"; {} {} in all\n", n_spaces - shown,
        report.spaces.back().patch->name, n_spaces,
        report.spaces.back().patch->finger ? "sites of a finger" : "active nodes");
}

void sayDevice(std::string& text, const Scene& scene, double stiffness) {
  if (!scene.device) return;
  const DeviceProfile& profile = scene.device->profile;
  say(text, "device     {}: up to {:.4g} m, {:.4g} N, {:.4g} N/m\n", profile.name,
      profile.workspace_radius, profile.max_force, profile.max_stiffness);
  if (stiffness > profile.max_stiffness)
    say(text,
        "           the tissue has up to {:.4g} N/m, stiffer than this device renders: the device "
        "may buzz, or the tissue may feel softer\n",
        stiffness);
  if (const auto radius = scene.device->wanted_radius)
    say(text, "           workspace.radius cut from {:.4g} to {:.4g} m\n", *radius,
        scene.workspace.radius);
  if (const auto force = scene.device->wanted_max_force)
    say(text, "           workspace.max_force cut from {:.4g} to {:.4g} N\n", *force,
        scene.workspace.max_force);
}

void sayAccuracy(std::string& text, const Scene& scene) {
  const Accuracy& accuracy = scene.accuracy;
  if (accuracy.adaptive())
    say(text, "accuracy   allowed force error max({:.3g} %, {:.3g} N); cells are split {}\n",
        100 * accuracy.force_error, accuracy.force_floor,
        accuracy.levels == 1 ? "at most once" : fmt::format("up to {} times", accuracy.levels));
  std::map<std::string, int> places;
  bool in_spaces = false;
  for (std::size_t s = 0; s < scene.active.size(); ++s)
    if (scene.active[s].isProbe())
      ++places[scene.active[s].probe_of];
    else
      in_spaces = in_spaces || probesIn(scene, s) > 0;
  for (const auto& [area, count] : places)
    say(text, "probes     at {} of \"{}\"\n", counted(count, "place"), area);
  if (in_spaces) say(text, "probes     {} in each space\n", accuracy.probes);
}

/// Returns whether some tool is a finger that only pushes. The lattice of such a finger is smaller
/// than the ball (PushedPart).
bool isOfFingersThatPush(const Problem& problem) {
  return problem.scene.contact == ContactMode::unilateral &&
         std::ranges::any_of(problem.active, [](const ActivePatch& p) { return bool(p.finger); });
}

void sayCost(std::string& text, const SceneReport& report) {
  const MeasuredPaths& measured = report.measured;
  if (!measured.no_rest.empty()) return;  // a warning says so, and there is no estimate
  const Estimate &least = report.cost.least, &likely = report.cost.likely;
  const auto onAllCores = [&](const Estimate& e) { return duration(e.seconds / report.cores); };
  say(text, "cost       about {} on one core, {} on the {} of this machine; dataset {:.3g} MB\n",
      duration(likely.seconds), onAllCores(likely), counted(report.cores, "core"),
      likely.bytes / 1e6);
  if (report.problem->scene.accuracy.adaptive())
    say(text,
        "           with refinement of the cells that are too coarse along the trial paths: about "
        "{} configurations; {} on one core without refinement\n",
        likely.configurations, duration(least.seconds));
  say(text,
      "           estimated from {} transitions on {} trial paths from rest, solved in {} with {}; "
      "about {:.0f} % of the lattice points are reached\n",
      measured.transitions, measured.paths.size(), duration(measured.seconds), report.arithmetic,
      100 * report.cost.reached);
}

}  // namespace

std::string sceneReportText(const SceneReport& report) {
  std::string text;
  const Scene& scene = report.problem->scene;
  say(text, "scene      {}\n", scene.name);
  say(text, "{}", meshText(report.problem->mesh, report.quality, scene.mesh.filename().string()));
  sayConversion(text, scene);
  sayBody(text, report);
  say(text, "fixed      {}\n", counted(report.problem->fixed.size(), "node"));
  sayActives(text, report);
  sayDevice(text, scene, report.measured.stiffness);
  say(text,
      "lattice    radius {:.4g} m, spacing {:.4g} m: {}{} in each of {}, {}{} configurations\n",
      report.lattice.radius(), report.lattice.spacing(),
      isOfFingersThatPush(*report.problem) ? "up to " : "", counted(report.lattice.size(), "point"),
      counted(report.spaces.size(), "space"), scene.accuracy.adaptive() ? "at least " : "",
      report.cost.least.configurations);
  sayAccuracy(text, scene);
  sayCost(text, report);
  for (const std::string& warning : report.warnings) say(text, "warning    {}\n", warning);
  return text;
}

}  // namespace palpate
