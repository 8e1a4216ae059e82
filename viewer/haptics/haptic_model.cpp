#include "viewer/haptics/haptic_model.hpp"

#include <algorithm>
#include <iterator>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/base/parallel.hpp"
#include "common/problem/sites.hpp"
#include "viewer/fields/field_choice.hpp"
#include "viewer/haptics/guessed_sites.hpp"

namespace palpate {
namespace {

/// Returns the radius of the finger, or of the patch around the active node, m.
double radiusOf(const ActivePatch& patch, const Mesh& mesh) {
  if (patch.finger) return patch.finger->radius;
  double radius = 0;
  for (const std::int32_t node : patch.nodes)
    radius = std::max(radius, (mesh.nodes[at(node)] - mesh.nodes[at(patch.node)]).norm());
  return radius;
}

/// Returns a copy of `space`, which has no solved point, with the rest position marked as solved.
SpaceTable atRest(SpaceTable space) {
  space.points.front().tag = Tag::expandable;
  return space;
}

}  // namespace

HapticModel::HapticModel(const Dataset& dataset, const HapticModelOptions& options)
    : scene_(dataset.scene()),
      file_(dataset.file().string()),
      content_(dataset.contentId()),
      build_(dataset.buildId()),
      surface_(dataset, options.reach, options.guess),
      spaces_(dataset.spaces()),
      guessed_(spaces_.size()),
      methods_(options.methods),
      fields_(options.methods.size()),
      pressures_(scene_, options.pressures ? spaces_.size() : 0) {
  PALPATE_ASSERT(!spaces_.empty(), "a dataset must have an active node");
  if (methods_.empty()) throw badInput("{}: no interpolation method was given", file_);
  if (options.guess) guessUnfinished();
  for (const SpaceTable& space : spaces_)
    tool_radii_.push_back(radiusOf(space.patch, dataset.mesh()));
  for (MethodFields& of_method : fields_) of_method.of_space.resize(spaces_.size());
  for (const TouchArea& area : surface_.areas())
    places_.push_back(
        placesAround(dataset.mesh(), centersOf(chosenOf(spaces_, area.spaces)), area.radius));
  for (std::size_t method = 0; options.prepare && method < methods_.size(); ++method)
    prepare(method);
  readShapes(dataset, options.pressures, options.stop);
  if (options.pressures && options.prepare) preparePressures();
}

void HapticModel::guessUnfinished() {
  for (const TouchArea& area : surface_.areas())
    for (const std::size_t space : area.spaces) {
      if (!isUnfinished(spaces_[space])) continue;
      guess(spaces_[space], scene_);
      guessed_[space] = true;
    }
}

void HapticModel::readShapes(const Dataset& dataset, bool with_pressures,
                             const std::stop_token& stop) {
  shapes_.resize(spaces_.size());
  std::mutex reading;  // one thread at a time, because a dataset is a single file
  inParallel(spaces_.size(), [&](std::size_t s) {
    if (stop.stop_requested())
      throw Error(ExitCode::interrupted, file_ + ": loading was interrupted");
    std::unique_lock lock(reading);
    NodalFields fields = dataset.surfaceFields(s);
    lock.unlock();
    if (guessed_[s]) {
      fields.displacement = guessedShapes(spaces_[s], surface_.vertices());
      std::ranges::fill(fields.pressure, 0.0F);
    }
    if (with_pressures) pressures_.keep(s, std::move(fields.pressure));
    const bool solved = hasSolvedPoint(spaces_[s]);
    if (!solved) std::ranges::fill(fields.displacement, 0.0F);
    const std::vector<float>& displacements = fields.displacement;
    PALPATE_ASSERT(
        displacements.size() == 3 * spaces_[s].points.size() * surface_.vertices().size(),
        "a dataset must store the displacements of surface nodes");
    shapes_[s] = std::make_unique<DisplacementField>(solved ? spaces_[s] : atRest(spaces_[s]),
                                                     displacements);
  });
}

bool HapticModel::makeAreas(const std::stop_token& stop) {
  struct Stopped {};
  // std::call_once would never return after an exception under the thread sanitizer.
  const std::scoped_lock lock(making_areas_);
  if (areas_made_) return true;
  areas_share_ = 0;
  std::vector<std::shared_ptr<const AreaField>> areas;
  const auto progress = [&](double share) {
    if (stop.stop_requested()) throw Stopped();
    share = (static_cast<double>(areas.size()) + share) / static_cast<double>(places_.size());
    // Keep the largest share, because threads may report out of order.
    for (double known = areas_share_; share > known;)
      if (areas_share_.compare_exchange_weak(known, share)) break;
  };
  try {
    for (std::size_t a = 0; a < places_.size(); ++a)
      areas.push_back(std::make_shared<const AreaField>(
          chosenOf(spaces_, surface_.areas()[a].spaces), places_[a], progress));
  } catch (const Stopped&) {
    return false;
  }
  PALPATE_ASSERT(areas.size() == surface_.areas().size(),
                 "each area of the surface must have an energy");
  areas_ = std::move(areas);
  findGuessedPlaces();
  areas_made_ = true;
  return true;
}

void HapticModel::findGuessedPlaces() {
  std::vector<Eigen::Vector3d> places;
  for (std::size_t a = 0; a < areas_.size(); ++a) {
    const auto isGuessed = [&](std::size_t space) -> bool { return guessed_[space]; };
    std::ranges::copy(
        areas_[a]->collocationPointsFrom(mapped(surface_.areas()[a].spaces, isGuessed)),
        std::back_inserter(places));
  }
  if (!places.empty()) guessed_places_ = NearPoints(places, areas_.front()->collocationReach());
}

void HapticModel::prepare(std::size_t method, const std::stop_token& stop, bool alone) {
  PALPATE_ASSERT(method < methods_.size(), "the interpolation method must exist");
  // Make the areas before the spaces, because making areas already uses all cores.
  if (!makeAreas(stop)) return;
  const auto makeNext = [&](std::size_t space) {
    if (!stop.stop_requested()) make(method, space);
  };
  if (!alone) return inParallel(spaces_.size(), makeNext);
  for (std::size_t space = 0; space < spaces_.size(); ++space) makeNext(space);
}

void HapticModel::make(std::size_t method, std::size_t space) {
  MethodFields& fields = fields_[method];
  if (fields.of_space[space]) return;
  if (const std::int32_t area = surface_.areaOfSpace(space); area >= 0)
    fields.of_space[space] = std::make_unique<FieldAtPlace>(
        areas_[at(area)], spaces_[space].patch.finger.value().center);
  else
    fields.of_space[space] = makeForceField(methods_[method], spaces_[space]);
  PALPATE_ASSERT(fields.of_space[space] != nullptr, "a prepared force field must exist");
  fields.made.fetch_add(1, std::memory_order_release);
}

void HapticModel::preparePressures(const std::stop_token& stop) {
  pressures_.prepare(spaces_, stop);
}

double HapticModel::preparedShare(std::size_t method) const noexcept {
  if (method >= fields_.size()) return 0;
  if (isPrepared(method)) return 1;
  const auto made = static_cast<double>(fields_[method].made.load(std::memory_order_relaxed));
  // Stay below 1, because a share of 1 means that field() may be called.
  return std::min(0.99, std::max(made / static_cast<double>(spaces_.size()),
                                 areas_share_.load(std::memory_order_relaxed)));
}

}  // namespace palpate
