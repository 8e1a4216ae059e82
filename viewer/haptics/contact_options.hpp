#pragma once

#include "common/scene/scene.hpp"

namespace palpate {

struct ContactOptions {
  ContactMode mode = ContactMode::unilateral;
  double friction = 0.2;         ///< Coulomb's coefficient, >= 0; unilateral only
  double grab_distance = 0.005;  ///< m; glued: the tool takes hold of a surface this near
  double most_slide = 0.002;     ///< m per tick that the anchor may slide at most
  /// Of the force, per tick: what sliding may change it by beyond what the tool's own motion does.
  /// So the force stays continuous where the anchor runs down from a ridge between two triangles.
  /// Smaller is softer, and lags behind.
  double most_relaxation = 0.005;
};

}  // namespace palpate
