#include "viewer/export/configuration_source.hpp"

#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/base/number_text.hpp"
#include "common/base/text.hpp"
#include "common/problem/finger.hpp"
#include "common/space/lattice.hpp"

namespace palpate {

ExportedConfiguration ConfigurationSource::interpolated(const ForceAnswers& answers,
                                                        const WayStep& step) {
  const ForceAnswer& answer = step.answer;
  if (!shape_) shape_.emplace(dataset_, answers.choice());
  const ActivePatch& patch = answers.firstSpace().patch;
  ExportedConfiguration configuration = touchedBy(patch);
  std::optional<Eigen::Vector3d> place;
  if (answer.finger) {
    place = configuration.place = answer.finger->at;
    configuration.drive = answer.finger->drive;
    configuration.touched =
        fingerWeights(dataset_.mesh(), dataset_.fixedNodes(), *place, patch.finger.value().radius)
            .nodes;
  }
  configuration.displacement = step.touch.displacement;
  configuration.fields =
      shape_->at(place, step.touch.displacement - answer.sample.excessOf(step.touch.displacement));
  configuration.sample = answer.sample;
  configuration.active = answers.choice().name;
  configuration.method = answers.method();
  return configuration;
}

ExportedConfiguration ConfigurationSource::solved(const std::string& active,
                                                  const std::optional<Eigen::Vector3d>& place,
                                                  const Eigen::Vector3d& point) const {
  const std::size_t number = spaceOf(active, place);
  const SpaceTable& space = dataset_.spaces()[number];
  const std::int32_t n = pointNamed(space.lattice, point);
  if (!isSolved(space.points[at(n)].tag)) refuseUnsolved(space, n, point);
  const Equilibrium& equilibrium = space.points[at(n)].equilibrium;
  ExportedConfiguration configuration = touchedBy(space.patch);
  configuration.fields = dataset_.fields(number, n);
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

std::size_t ConfigurationSource::spaceOf(const std::string& active,
                                         const std::optional<Eigen::Vector3d>& place) const {
  const ActiveChoice choice = chooseActive(dataset_.scene(), active);
  requirePlace(choice, place.has_value());
  if (!place) return choice.spaces.front();
  return nearestSite(dataset_.spaces(), choice.spaces,
                     fingerNear("--at", dataset_.mesh(), *place, 0).center);
}

ExportedConfiguration ConfigurationSource::touchedBy(const ActivePatch& patch) const {
  ExportedConfiguration configuration;
  configuration.place = patch.finger ? patch.finger->center : dataset_.mesh().nodes[at(patch.node)];
  configuration.touched = patch.nodes;
  return configuration;
}

void ConfigurationSource::refuseUnsolved(const SpaceTable& space, std::int32_t number,
                                         const Eigen::Vector3d& point) const {
  const PointRecord& record = space.points[at(number)];
  const std::string file = dataset_.file().string();
  throw badInput(
      "{}: point ({}) of {} has the tag {}{} and no configuration; for the reason run: palpate "
      "explain {} --active {} {}",
      file, vectorText(point, 6), space.patch.name, name(record.tag),
      record.tag == Tag::failed ? fmt::format(" ({})", name(record.cause)) : "", shellWord(file),
      space.patch.name, vectorText(point, 6, " "));
}

}  // namespace palpate
