#include "viewer/c_api/touch_struct.hpp"

#include <algorithm>

#include "viewer/c_api/arguments.hpp"

namespace palpate {

static_assert(PALPATE_MOST_SHARES == most_blended_spaces);

palpate_touch toStruct(const Touch& touch) noexcept {
  palpate_touch given{};
  given.size = sizeof given;
  given.touching = touch.touching ? 1 : 0;
  given.stepped = touch.stepped ? 1 : 0;
  given.triangle = touch.anchor.triangle;
  giveForce(given, touch);
  give(given.barycentric, touch.anchor.barycentric);
  give(given.anchor, touch.anchor_position);
  give(given.normal, touch.normal);
  give(given.displacement, touch.displacement);
  given.gap = touch.gap;
  given.beyond = touch.beyond;
  give(given.drive, touch.drive);
  given.share_count = touch.blend.size;
  for (std::size_t s = 0; s < static_cast<std::size_t>(touch.blend.size); ++s) {
    given.share_spaces[s] = touch.blend.shares[s].space;
    given.share_weights[s] = touch.blend.shares[s].weight;
  }
  return given;
}

Touch toTouch(const palpate_touch& given) noexcept {
  Touch touch;
  touch.touching = given.touching != 0;
  touch.stepped = given.stepped != 0;
  touch.inside = given.inside != 0;
  touch.force = vectorOf(given.force);
  touch.stiffness = matrixOf(given.stiffness);
  touch.energy = given.energy;
  touch.error_bound = given.error_bound;
  touch.coverage = given.coverage;
  touch.anchor = {given.triangle, vectorOf(given.barycentric)};
  touch.anchor_position = vectorOf(given.anchor);
  touch.normal = vectorOf(given.normal);
  touch.displacement = vectorOf(given.displacement);
  touch.gap = given.gap;
  touch.beyond = std::max(0.0, given.beyond);
  touch.drive = vectorOf(given.drive);
  // The caller may have filled in the touch by hand, so the count may exceed the arrays.
  touch.blend.size = std::clamp(given.share_count, 0, PALPATE_MOST_SHARES);
  for (std::size_t s = 0; s < static_cast<std::size_t>(touch.blend.size); ++s)
    touch.blend.shares[s] = {given.share_spaces[s], given.share_weights[s]};
  return touch;
}

}  // namespace palpate
