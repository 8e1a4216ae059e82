#pragma once

#include <span>

#include "common/scene/scene.hpp"
#include "common/space/space_table.hpp"

namespace palpate {

/// Returns whether the build of a space is unfinished: whether a point has the tag `unknown`.
bool isUnfinished(const SpaceTable& space);

/// Replaces all points of a finger's site by a guess: a spring, about as stiff as the softest
/// material. A hand feels the guess in the first hundredths of a second of a contact, until the
/// live solver has answered, and whenever the live solver does not keep up.
void guess(SpaceTable& site, const Scene& scene);

/// Returns the guessed displacements of vertices, m, [point][vertex][axis], as DisplacementField
/// expects them. vertices: their positions at rest, m.
std::vector<float> guessedShapes(const SpaceTable& site, std::span<const Eigen::Vector3d> vertices);

}  // namespace palpate
