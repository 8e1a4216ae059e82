#pragma once

#include "common/space/space_table.hpp"
#include "proto/palpate.pb.h"

namespace palpate {

/// The space of the active node with that name; without a name the only one. Error (bad input) that
/// lists the names, the first of many, when there is no such one.
const SpaceTable& spaceNamed(const std::vector<SpaceTable>& spaces, const std::string& wanted);
/// Of the sites of a finger's area, or of all without a name, the one nearest to a place, metres.
/// Error (bad input) without any, or for a place that is not finite.
const SpaceTable& siteNearest(const std::vector<SpaceTable>& spaces, const std::string& area,
                              const Eigen::Vector3d& place);

/// What is known of each space by now, from a dataset or a state directory. Of a directory it takes
/// the time and memory of a start there.
std::vector<SpaceTable> spacesIn(const std::string& where);

/// How a lattice point of one space, given in spacings, was reached: the chain of parents back to
/// the origin; or why it was not: every attempt. `text` says it for people. Error (bad input),
/// naming the bounds, when the point is not in the lattice.
wire::Explanation explain(const SpaceTable& space, const Eigen::Vector3d& in_spacings);

}  // namespace palpate
