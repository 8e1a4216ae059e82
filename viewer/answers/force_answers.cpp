#include "viewer/answers/force_answers.hpp"

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/problem/finger.hpp"
#include "common/problem/sites.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

/// Replaces -0 by 0, because the sign of a zero means nothing to a reader.
ForceAnswer withoutSigns(ForceAnswer answer) {
  ForceSample& sample = answer.sample;
  sample.force.array() += 0.0;
  sample.stiffness.array() += 0.0;
  sample.energy += 0.0;
  if (answer.finger) answer.finger->drive.array() += 0.0;
  return answer;
}

}  // namespace

ForceAnswers::ForceAnswers(const Dataset& dataset, const std::string& active, bool with_places,
                           const std::string& method)
    : dataset_(dataset),
      choice_(chooseActive(dataset.scene(), active)),
      first_(dataset.spaces()[choice_.spaces.front()]),
      method_(method) {
  PALPATE_ASSERT(choice_.spaces.back() < dataset.spaces().size(),
                 "each active node must have a space in the dataset");
  requirePlace(choice_, with_places);
  if (!with_places) {
    field_ = makeForceField(method, first_);
    return;
  }
  if (const std::string& only = forceFieldMethods().front(); method != only)
    throw badInput("--method {}: only {} interpolates between the sites of a finger", method, only);
  const auto sites = chosenOf(dataset.spaces(), choice_.spaces);
  const std::vector<Eigen::Vector3d> centers = centersOf(sites);
  const double radius = first_.patch.finger->radius;
  area_ = std::make_unique<AreaField>(
      sites, AreaField::collocationPointsOf(sites, placesAround(dataset.mesh(), centers, radius)));
  places_.emplace(dataset.mesh(), dataset.fixedNodes(), centers, radius);
}

ForceAnswer ForceAnswers::answer(const TouchInput& touch) const {
  if (!area_) {
    PALPATE_ASSERT(!touch.at, "only a touch of a surface can have a place");
    return withoutSigns({field_->evaluate(touch.displacement), std::nullopt});
  }
  PALPATE_ASSERT(touch.at.has_value(), "a touch of a surface must have a place");
  fingerNear("--at", dataset_.mesh(), *touch.at, 0);  // refuses places far outside the body
  const FingerPlace place = places_->placeOf(*touch.at, touch.displacement);
  if (place.triangle >= 0) area_->prepareAt(place.at);
  return withoutSigns(places_->answer(*area_, *touch.at, touch.displacement));
}

}  // namespace palpate
