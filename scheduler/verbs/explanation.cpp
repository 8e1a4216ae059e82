#include "scheduler/verbs/explanation.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/base/number_text.hpp"
#include "common/dataset/dataset.hpp"
#include "common/problem/problem.hpp"
#include "common/scene/active_choice.hpp"
#include "common/space/lattice.hpp"
#include "common/wire/wire.hpp"
#include "scheduler/builds/recorded_build.hpp"
#include "scheduler/verbs/status_text.hpp"

namespace palpate {
namespace {

std::string textOf(const wire::Explanation& e) {
  const std::string where =
      fmt::format("{}: point {}, displacement ({}) m", e.active(),
                  pointText(fromWire(e.point()), e.divisions()),
                  vectorText({e.displacement(0), e.displacement(1), e.displacement(2)}, 6));
  std::string text =
      fmt::format("{}: {}{}\n", where, e.tag(), e.cause().empty() ? "" : ", " + e.cause());
  if (e.path_size() > 0) text += "reached by these transitions, the last one first:\n";
  for (const wire::Step& s : e.path())
    text +=
        fmt::format("  {:<14} force ({}) N, energy {:.4g} J, min det F {:.3g}, {} in {}\n",
                    pointText(fromWire(s.point()), e.divisions()),
                    vectorText({s.force(0), s.force(1), s.force(2)}, 4), s.energy(), s.min_det_f(),
                    counted(s.newton_iterations(), "iteration"), counted(s.steps(), "step"));
  if (e.attempts_size() > 0) text += "tried without success:\n";
  for (const wire::FailedTry& t : e.attempts())
    text +=
        fmt::format("  from {}: {}\n", pointText(fromWire(t.parent()), e.divisions()), t.text());
  if (e.path_size() > 0 || e.attempts_size() > 0) return text;
  text += e.cause().empty() ? "no solve of this point has been tried yet"
                            : describe(Failure{.cause = Cause::unreachable});
  text += '\n';
  return text;
}

}  // namespace

const SpaceTable& KnownSpaces::named(const std::string& active,
                                     const std::optional<Eigen::Vector3d>& place) const {
  // First look for the name of a site or probe place. chooseActive() does not know these names.
  const auto exact =
      std::ranges::find(spaces, active, [](const SpaceTable& space) { return space.patch.name; });
  if (exact != spaces.end() && !place) return *exact;
  const ActiveChoice choice = chooseActive(scene, active);
  requirePlace(choice, place.has_value());
  PALPATE_ASSERT(choice.spaces.back() < spaces.size(), "each active node must have a table");
  if (!place) return spaces[choice.spaces.front()];
  if (!place->allFinite()) throw badInput("--at: give three finite numbers, metres");
  return spaces[nearestSite(spaces, choice.spaces, *place)];
}

wire::Explanation explain(const SpaceTable& space, const Eigen::Vector3d& in_spacings) {
  const Lattice& lattice = space.lattice;
  PALPATE_ASSERT(space.points.size() == at(lattice.size()), "each lattice point must have a row");
  const std::int32_t number = pointNamed(lattice, in_spacings);
  const PointRecord& record = space.points[at(number)];
  wire::Explanation explanation;
  explanation.set_active(space.patch.name);
  *explanation.mutable_point() = toWire(lattice.point(number));
  explanation.set_divisions(lattice.divisions());
  for (const double component : lattice.displacement(number))
    explanation.add_displacement(component);
  explanation.set_tag(std::string(name(record.tag)));
  if (record.tag == Tag::failed) explanation.set_cause(std::string(name(record.cause)));
  // Stop after as many steps as there are points: in a damaged file, parents may form a loop.
  std::int32_t step = record.parent < 0 ? -1 : number;
  for (std::size_t length = 0; step >= 0 && length < space.points.size(); ++length) {
    const PointRecord& here = space.points[at(step)];
    wire::Step& shown = *explanation.add_path();
    *shown.mutable_point() = toWire(lattice.point(step));
    shown.set_tag(std::string(name(here.tag)));
    for (const double component : here.equilibrium.force) shown.add_force(component);
    shown.set_energy(here.equilibrium.energy);
    shown.set_min_det_f(here.equilibrium.min_det_F);
    shown.set_newton_iterations(here.cost.newton_iterations);
    shown.set_steps(here.cost.steps);
    step = here.parent == step ? -1 : here.parent;
  }
  for (const FailedAttempt& attempt : space.attempts) {
    if (attempt.target != number) continue;
    wire::FailedTry& failed = *explanation.add_attempts();
    *failed.mutable_parent() = toWire(lattice.point(attempt.parent));
    failed.set_cause(std::string(name(attempt.failure.cause)));
    failed.set_text(describe(attempt.failure));
    failed.set_step_reached(attempt.failure.step_reached);
  }
  explanation.set_text(textOf(explanation));
  return explanation;
}

KnownSpaces spacesIn(const std::string& where) {
  if (!std::filesystem::is_directory(where)) {
    const Dataset dataset(where);
    return {dataset.scene(), dataset.spaces()};
  }
  const RecordedBuild build(where);
  return {build.problem().scene, mapped(build.plans(), &SpacePlan::table)};
}

}  // namespace palpate
