#pragma once

#include "viewer/export/configuration_grid.hpp"
#include "viewer/export/interpolated_shape.hpp"
#include "viewer/export/touch_way.hpp"

namespace palpate {

/// Returns the configuration at a step of a path, interpolated; does not set `way`. shape: of this
/// dataset and answers.choice(). answers: the object that answered the step. It must use this
/// dataset.
ExportedConfiguration interpolatedConfiguration(const Dataset& dataset, InterpolatedShape& shape,
                                                const ForceAnswers& answers, const WayStep& step);

/// Returns the solved configuration at a lattice point, given by its coordinates in spacings.
/// `active`: name of an active node or of a finger's area. In an area, the point belongs to the
/// site nearest to `place` (metres). Error (bad input) for an unknown name, a place without a
/// finger, an area without a place, and an unsolved point, whose tag and cause the message gives.
ExportedConfiguration solvedConfiguration(const Dataset& dataset, const std::string& active,
                                          const std::optional<Eigen::Vector3d>& place,
                                          const Eigen::Vector3d& point);

}  // namespace palpate
