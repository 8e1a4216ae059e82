#include "viewer/export/configuration_source.hpp"

#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/base/number_text.hpp"
#include "common/base/text.hpp"
#include "common/problem/finger.hpp"
#include "common/space/lattice.hpp"

namespace palpate {
namespace {

std::size_t spaceOf(const Dataset& dataset, const std::string& active,
                    const std::optional<Eigen::Vector3d>& place) {
  const ActiveChoice choice = chooseActive(dataset.scene(), active);
  requirePlace(choice, place.has_value());
  if (!place) return choice.spaces.front();
  return nearestSite(dataset.spaces(), choice.spaces,
                     fingerNear("--at", dataset.mesh(), *place, 0).center);
}

/// Returns a configuration with the data of the tool that its space determines: rest position and
/// touched nodes.
ExportedConfiguration touchedBy(const Dataset& dataset, const ActivePatch& patch) {
  ExportedConfiguration configuration;
  configuration.place = patch.finger ? patch.finger->center : dataset.mesh().nodes[at(patch.node)];
  configuration.touched = patch.nodes;
  return configuration;
}

[[noreturn]] void refuseUnsolved(const Dataset& dataset, const SpaceTable& space,
                                 std::int32_t number, const Eigen::Vector3d& point) {
  const PointRecord& record = space.points[at(number)];
  const std::string file = dataset.file().string();
  throw badInput(
      "{}: point ({}) of {} has the tag {}{} and no configuration; for the reason run: palpate "
      "explain {} --active {} {}",
      file, vectorText(point, 6), space.patch.name, name(record.tag),
      record.tag == Tag::failed ? fmt::format(" ({})", name(record.cause)) : "", shellWord(file),
      space.patch.name, vectorText(point, 6, " "));
}

}  // namespace

ExportedConfiguration interpolatedConfiguration(const Dataset& dataset, InterpolatedShape& shape,
                                                const ForceAnswers& answers, const WayStep& step) {
  const ForceAnswer& answer = step.answer;
  const ActivePatch& patch = answers.firstSpace().patch;
  ExportedConfiguration configuration = touchedBy(dataset, patch);
  std::optional<Eigen::Vector3d> place;
  if (answer.finger) {
    place = configuration.place = answer.finger->at;
    configuration.drive = answer.finger->drive;
    configuration.touched =
        fingerWeights(dataset.mesh(), dataset.fixedNodes(), *place, patch.finger.value().radius)
            .nodes;
  }
  configuration.displacement = step.touch.displacement;
  configuration.fields =
      shape.at(place, step.touch.displacement - answer.sample.excessOf(step.touch.displacement));
  configuration.sample = answer.sample;
  configuration.active = answers.choice().name;
  configuration.method = answers.method();
  return configuration;
}

ExportedConfiguration solvedConfiguration(const Dataset& dataset, const std::string& active,
                                          const std::optional<Eigen::Vector3d>& place,
                                          const Eigen::Vector3d& point) {
  const std::size_t number = spaceOf(dataset, active, place);
  const SpaceTable& space = dataset.spaces()[number];
  const std::int32_t n = pointNamed(space.lattice, point);
  if (!isSolved(space.points[at(n)].tag)) refuseUnsolved(dataset, space, n, point);
  const Equilibrium& equilibrium = space.points[at(n)].equilibrium;
  ExportedConfiguration configuration = touchedBy(dataset, space.patch);
  configuration.fields = dataset.fields(number, n);
  configuration.displacement = space.lattice.displacement(n);
  configuration.sample.force = equilibrium.force;
  configuration.sample.stiffness = equilibrium.stiffness;
  configuration.sample.energy = equilibrium.energy;
  configuration.sample.error_bound = 0;
  configuration.sample.coverage = 1;
  configuration.sample.inside = true;
  if (space.patch.finger) configuration.drive = equilibrium.drive;
  configuration.lattice_point = point;
  configuration.min_det_F = equilibrium.min_det_F;
  configuration.active = space.patch.name;
  configuration.method = "solved";
  return configuration;
}

}  // namespace palpate
