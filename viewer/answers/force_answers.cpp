#include "viewer/answers/force_answers.hpp"

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/mesh/surface_point.hpp"
#include "common/problem/finger.hpp"
#include "common/problem/sites.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

/// Zero without its sign: -0 means nothing to a reader.
template <class Derived>
auto plain(const Eigen::MatrixBase<Derived>& values) {
  return (values.array() + 0.0).matrix().eval();
}

template <class Sample>
Sample withoutSigns(Sample sample) {
  sample.force = plain(sample.force);
  sample.stiffness = plain(sample.stiffness);
  sample.energy += 0.0;
  return sample;
}

}  // namespace

ForceAnswers::ForceAnswers(const Dataset& dataset, const std::string& active, bool with_places,
                           const std::string& method)
    : dataset_(dataset),
      choice_(chooseActive(dataset.scene(), active)),
      first_(dataset.spaces()[choice_.spaces.front()]),
      method_(method) {
  requirePlace(choice_, with_places);
  if (!with_places) {
    field_ = makeForceField(method, first_);
    return;
  }
  if (const std::string& only = forceFieldMethods().front(); method != only)
    throw badInput("--method {}: between the sites of a finger there is only {}", method, only);
  const auto sites = chosenOf(dataset.spaces(), choice_.spaces);
  area_ = std::make_unique<AreaField>(
      sites, placesAround(dataset.mesh(), centersOf(sites), first_.patch.finger->radius));
}

ForceAnswer ForceAnswers::answer(const TouchInput& touch) const {
  if (!area_) return {withoutSigns(field_->evaluate(touch.displacement)), std::nullopt};
  PALPATE_ASSERT(touch.at.has_value(), "who makes answers for places asks with one");
  return answerAt(*touch.at, touch.displacement);
}

ForceAnswer ForceAnswers::answerAt(const Eigen::Vector3d& near, const Eigen::Vector3d& p) const {
  const Mesh& mesh = dataset_.mesh();
  const Eigen::Vector3d at = fingerNear("--at", mesh, near, 0).center;
  AreaSample sample = withoutSigns(area_->evaluate(at, p));
  const double radius = first_.patch.finger->radius;
  // `solve` refuses these; who asks for many places wants the others.
  if (fingerWeights(mesh, dataset_.fixedNodes(), at, radius).free_share < least_free_share)
    sample.inside = false;
  return {sample, FingerPlace{at, plain(alongSurface(mesh, at, sample.drive))}};
}

}  // namespace palpate
