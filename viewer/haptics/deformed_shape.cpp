#include "viewer/haptics/deformed_shape.hpp"

#include <algorithm>

#include "common/mesh/anchor_bump.hpp"

namespace palpate {
namespace {

/// Returns the displacement that a touch still needs at its anchor, m.
Eigen::Vector3d missingAt(const TouchSurface& surface, const Touch& touch,
                          std::span<const float> out) noexcept {
  Eigen::Vector3d missing = touch.displacement - touch.excess();
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t corner = at(surface.triangles()[at(touch.anchor.triangle)][c]);
    missing -= touch.anchor.barycentric[static_cast<Eigen::Index>(c)] *
               Eigen::Map<const Eigen::Vector3f>(out.data() + 3 * corner).cast<double>();
  }
  return missing;
}

/// Adds bumps to the displacements so that the anchor moves by exactly the displacement of the
/// touch.
void passThroughTool(const TouchSurface& surface, const Touch& touch,
                     std::span<float> out) noexcept {
  const Triangle& t = surface.triangles()[at(touch.anchor.triangle)];
  // The radius is large enough that the bump always contains a corner of the anchor's triangle.
  double radius = 0;
  for (std::size_t c = 0; c < 3; ++c)
    radius +=
        2 * touch.anchor.barycentric[static_cast<Eigen::Index>(c)] * surface.longestEdgeAt(t[c]);
  moveAnchor(surface.vertices(), t, touch.anchor.barycentric, touch.anchor_position, radius,
             touch.displacement - touch.excess(), out);
}

}  // namespace

DeformedShape::DeformedShape(std::size_t most_vertices) : scratch_(3 * most_vertices) {}

void DeformedShape::evaluate(const HapticModel& model, std::span<const Touch> touches,
                             std::span<float> out) noexcept {
  std::ranges::fill(out, 0.0f);
  // Each tool also moves the surface under the other one, so one round is not enough for two.
  const auto rounds = std::ranges::count(touches, true, &Touch::touching);
  for (auto round = rounds; round > 0; --round)
    for (const Touch& touch : touches)
      if (touch.touching) add(model, touch.blend, missingAt(model.surface(), touch, out), out);
  for (auto round = rounds; round > 0; --round)
    for (const Touch& touch : touches)
      if (touch.touching) passThroughTool(model.surface(), touch, out);
}

void DeformedShape::add(const HapticModel& model, const SpaceBlend& blend,
                        const Eigen::Vector3d& displacement, std::span<float> out) noexcept {
  const std::span<float> one = std::span(scratch_).first(std::min(out.size(), scratch_.size()));
  for (const SpaceWeight& share : blend.used()) {
    const auto weight = static_cast<float>(share.weight);
    model.shape(at(share.space)).evaluate(displacement, one);
    for (std::size_t i = 0; i < one.size(); ++i) out[i] += weight * one[i];
  }
}

}  // namespace palpate
