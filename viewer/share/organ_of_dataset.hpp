#pragma once

#include "common/dataset/dataset.hpp"
#include "viewer/organ/carried_organ.hpp"

namespace palpate {

/// Returns the part of a dataset that a page contains. Takes a few seconds, because it reduces the
/// shapes to modes (proper orthogonal decomposition of all solved shapes). Error if the surface has
/// more than 65,536 vertices.
CarriedOrgan organOf(const Dataset& dataset);

}  // namespace palpate
