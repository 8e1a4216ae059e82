#include "scheduler/verbs/explanation.hpp"

#include <limits>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/base/number_text.hpp"
#include "common/dataset/dataset.hpp"
#include "common/problem/problem.hpp"
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
  text += e.cause().empty() ? "no transition to it was tried yet: the build has not come so far"
                            : describe(Failure{.cause = Cause::unreachable});
  text += '\n';
  return text;
}

/// Sites are called AREA-NUMBER.
bool isOrIsSiteOf(const std::string& name, const std::string& area) {
  if (!name.starts_with(area)) return false;
  const std::string rest = name.substr(area.size());
  return rest.empty() || (rest.size() > 1 && rest.front() == '-' &&
                          rest.find_first_not_of("0123456789", 1) == std::string::npos);
}

}  // namespace

const SpaceTable& spaceNamed(const std::vector<SpaceTable>& spaces, const std::string& wanted) {
  if (wanted.empty() && spaces.size() == 1) return spaces.front();
  constexpr std::size_t most_listed = 12;
  std::vector<std::string> known;
  for (const SpaceTable& space : spaces) {
    if (space.patch.name == wanted) return space;
    if (known.size() < most_listed) known.push_back(space.patch.name);
  }
  std::string names = fmt::format("{}", fmt::join(known, ", "));
  if (spaces.size() > most_listed) names += fmt::format(", ... ({} in all)", spaces.size());
  if (spaces.back().patch.finger) names += "; the one nearest to a place is found with --at X Y Z";
  if (wanted.empty()) throw badInput("--active is needed: the active nodes are {}", names);
  throw badInput("--active {}: there is no active node of that name; there are: {}", wanted, names);
}

const SpaceTable& siteNearest(const std::vector<SpaceTable>& spaces, const std::string& area,
                              const Eigen::Vector3d& place) {
  if (!place.allFinite()) throw badInput("--at: a place has three finite numbers, metres");
  const SpaceTable* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const SpaceTable& space : spaces) {
    const ActivePatch& patch = space.patch;
    if (!patch.finger || patch.probe) continue;
    if (!area.empty() && !isOrIsSiteOf(patch.name, area)) continue;
    const double distance = (patch.finger->center - place).norm();
    if (distance >= least) continue;
    nearest = &space;
    least = distance;
  }
  if (!nearest) throw badInput("--at: {} no finger", area.empty() ? "there is" : area + " is");
  return *nearest;
}

wire::Explanation explain(const SpaceTable& space, const Eigen::Vector3d& in_spacings) {
  const Lattice& lattice = space.lattice;
  PALPATE_ASSERT(space.points.size() == at(lattice.size()), "a table has a row for every point");
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
  // A chain of parents is shorter than the lattice, also in a damaged file.
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

std::vector<SpaceTable> spacesIn(const std::string& where) {
  if (!std::filesystem::is_directory(where)) return Dataset(where).spaces();
  return spaceTables(RecordedBuild(where).plans());
}

}  // namespace palpate
