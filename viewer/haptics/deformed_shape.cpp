#include "viewer/haptics/deformed_shape.hpp"

#include <algorithm>

#include "common/mesh/anchor_bump.hpp"

namespace palpate {
namespace {

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

void DeformedShape::evaluate(const HapticModel& model, const Touch& touch,
                             std::span<float> out) noexcept {
  std::ranges::fill(out, 0.0f);
  if (!touch.touching) return;
  blend(model, touch, out);
  passThroughTool(model.surface(), touch, out);
}

void DeformedShape::blend(const HapticModel& model, const Touch& touch,
                          std::span<float> out) noexcept {
  const std::span<float> one = std::span(scratch_).first(std::min(out.size(), scratch_.size()));
  const Eigen::Vector3d displacement = touch.displacement - touch.excess();
  for (const SpaceWeight& share : touch.blend.used()) {
    const auto weight = static_cast<float>(share.weight);
    model.shape(at(share.space)).evaluate(displacement, one);
    for (std::size_t i = 0; i < one.size(); ++i) out[i] += weight * one[i];
  }
}

}  // namespace palpate
