#pragma once

#include "common/space/lattice.hpp"
#include "common/space/space_table.hpp"
#include "proto/palpate.pb.h"

namespace palpate {

/// How a lattice point of one space, given in spacings, was reached: the chain of parents back to
/// the origin; or why it was not: every attempt. `text` says it for people. Error (bad input),
/// naming the bounds, when the point is not in the lattice.
wire::Explanation explain(const SpaceTable& space, const Eigen::Vector3d& in_spacings);

/// As JSON with the field names of wire::Explanation.
std::string toJson(const wire::Explanation& explanation);

}  // namespace palpate
