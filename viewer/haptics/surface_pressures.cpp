#include "viewer/haptics/surface_pressures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/assertion.hpp"
#include "common/scene/material.hpp"

namespace palpate {
namespace {

bool isMixedRegion(const Region& region) { return isMixed(region.material); }

}  // namespace

PressureSource pressureSourceOf(const Scene& scene) {
  if (std::ranges::none_of(scene.regions, isMixedRegion)) return PressureSource::material;
  if (scene.discretization.pressure == PressureSpace::none) return PressureSource::formulation;
  return scene.storage.displacement == StoredNodes::all ? PressureSource::stored
                                                        : PressureSource::storage;
}

double strengthOf(std::span<const float> pressures) {
  std::vector<float> magnitudes;
  magnitudes.reserve(pressures.size());
  for (const float pressure : pressures)
    if (!std::isnan(pressure)) magnitudes.push_back(std::abs(pressure));
  if (magnitudes.empty()) return 0;
  const auto strong = magnitudes.begin() + std::ssize(magnitudes) * 19 / 20;
  std::ranges::nth_element(magnitudes, strong);
  return double{*strong};
}

SurfacePressures::SurfacePressures(const Scene& scene, std::size_t spaces)
    : source_(pressureSourceOf(scene)),
      rows_(spaces),
      fields_(spaces),
      everywhere_(std::ranges::all_of(scene.regions, isMixedRegion)) {}

void SurfacePressures::prepare(const std::vector<SpaceTable>& spaces, const std::stop_token& stop) {
  if (source_ != PressureSource::stored || fields_.empty()) return;
  PALPATE_ASSERT(spaces.size() == fields_.size(), "each space must have its pressures");
  for (std::size_t s = made_; s < fields_.size(); ++s) {
    if (stop.stop_requested()) return;
    takeIn(spaces[s], rows_[s]);
    fields_[s] = std::make_unique<PressureField>(spaces[s], rows_[s]);
    rows_[s] = {};
    if (s + 1 == fields_.size()) {
      const auto middle = strengths_.begin() + std::ssize(strengths_) / 2;
      std::ranges::nth_element(strengths_, middle);
      usual_ = *middle;
      strengths_ = {};
    }
    made_.store(s + 1, std::memory_order_release);
  }
}

void SurfacePressures::takeIn(const SpaceTable& space, std::span<const float> rows) {
  PALPATE_ASSERT(!space.points.empty() && rows.size() % space.points.size() == 0,
                 "each point must have pressures at all vertices");
  const std::size_t row = rows.size() / space.points.size();
  known_.resize(row, everywhere_ ? 1 : 0);
  std::vector<float> known(row);
  for (std::size_t n = 0; n < space.points.size(); ++n) {
    if (!isSolved(space.points[n].tag)) continue;
    for (std::size_t v = 0; v < row; ++v) {
      known[v] = rows[n * row + v];
      if (known[v] != 0)
        known_[v] = 1;
      else if (!everywhere_)
        known[v] = std::numeric_limits<float>::quiet_NaN();
    }
    strengths_.push_back(strengthOf(known));
  }
}

double SurfacePressures::preparedShare() const noexcept {
  if (fields_.empty()) return 0;
  return static_cast<double>(made_.load(std::memory_order_relaxed)) /
         static_cast<double>(fields_.size());
}

void SurfacePressures::evaluate(const SpaceBlend& blend, const Eigen::Vector3d& displacement,
                                std::span<float> out) const noexcept {
  std::ranges::fill(out, 0.0F);
  // At rest any space will do, because all spaces of a body have the same state at rest.
  if (blend.size == 0) fields_.front()->add(Eigen::Vector3d::Zero(), 1, out);
  for (const auto& [space, weight] : blend.used())
    fields_[at(space)]->add(displacement, weight, out);
  for (std::size_t v = 0; v < out.size(); ++v)
    if (known_[v] == 0) out[v] = std::numeric_limits<float>::quiet_NaN();
}

}  // namespace palpate
