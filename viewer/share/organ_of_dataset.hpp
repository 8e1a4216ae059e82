#pragma once

#include "common/dataset/dataset.hpp"
#include "viewer/organ/carried_organ.hpp"

namespace palpate {

/// What of a dataset a page carries. Some seconds of work, in which shapes are reduced to modes
/// (proper orthogonal decomposition of all solved shapes). Error when the surface has more than
/// 65,536 vertices.
CarriedOrgan organOf(const Dataset& dataset);

}  // namespace palpate
