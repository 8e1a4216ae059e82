#pragma once

#include "common/scene/scene.hpp"

namespace palpate {

class HapticModel;
class LiveTouch;

struct ContactOptions {
  ContactMode mode = ContactMode::unilateral;
  double friction = 0.2;         ///< Coulomb friction coefficient, >= 0; unilateral only
  double grab_distance = 0.005;  ///< m; glued: the tool grips a surface within this distance
  double most_slide = 0.002;     ///< largest slide of the anchor per tick, m
  /// Per tick, sliding changes the force by at most this fraction of the force, in addition to the
  /// change by the tool's own motion. This keeps the force continuous while the anchor slides down
  /// from a ridge between two triangles. Smaller values feel softer and lag more.
  double most_relaxation = 0.005;
  /// Source of equilibria near the hand that correct the areas of `live_model`; null: no
  /// correction. Both must outlive the contact. Only one contact at a time may use a LiveTouch.
  LiveTouch* live = nullptr;
  const HapticModel* live_model = nullptr;
  double period = 1e-3;  ///< time between two updates, s; used only with `live`
};

}  // namespace palpate
