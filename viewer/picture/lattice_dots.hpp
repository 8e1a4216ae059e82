#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "common/space/space_table.hpp"
#include "viewer/fields/force_field.hpp"
#include "viewer/fields/relative_error.hpp"

namespace palpate {

/// A place in a configuration space and the colour it is drawn in.
struct LatticeDot {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m
  std::array<double, 3> colour = {0, 0, 0};                ///< red, green, blue, 0 to 255
};

/// A plane at right angles to an axis; keeps what is nearer to it than half a spacing.
struct LatticeCut {
  int axis = 2;       ///< 0, 1, 2
  double offset = 0;  ///< m
  bool operator==(const LatticeCut&) const = default;
};

/// The colour of a tag: expandable green, terminating orange, failed red, unknown grey.
std::array<double, 3> colourOf(Tag tag);
/// The points of a space, all or those in a cut, coloured by tag.
std::vector<LatticeDot> tagDots(const SpaceTable& space, const std::optional<LatticeCut>& cut);

/// A bound on the error of a force as a share of it: bound / max(|force|, relative_error_floor).
double relativeError(double bound, double force);

/// The error bound in the middle of one cell, as a share of the force there.
struct CellError {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m
  /// relativeError; NaN: the method gives no bound there.
  double relative = 0;
};
/// Of all cells of the uniform lattice whose middle is in the ball. Evaluates the field in each:
/// some milliseconds.
std::vector<CellError> cellErrors(const SpaceTable& space, const ForceField& field);

/// The ends of the colours of errors, ten times below and above usual_force_error. They are fixed:
/// no outlier changes what a colour means.
inline constexpr double lowest_error = 0.1 * usual_force_error;
inline constexpr double highest_error = 10 * usual_force_error;
/// Where a relative error lies among the colours, 0 to 1, by its logarithm.
double errorPlace(double relative);

/// Coloured by viridis; what has no bound is left out.
std::vector<LatticeDot> errorDots(const std::vector<CellError>& errors, double spacing,
                                  const std::optional<LatticeCut>& cut);

}  // namespace palpate
