#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "common/space/space_table.hpp"
#include "viewer/fields/force_field.hpp"
#include "viewer/fields/relative_error.hpp"

namespace palpate {

/// A point of a configuration space, and its colour.
struct LatticeDot {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m
  std::array<double, 3> colour = {0, 0, 0};                ///< red, green, blue, 0 to 255
};

/// A plane perpendicular to an axis. A cut shows only points that are at most half a spacing away
/// from the plane.
struct LatticeCut {
  int axis = 2;       ///< 0, 1, 2
  double offset = 0;  ///< m
  bool operator==(const LatticeCut&) const = default;
};

/// Returns the colour of a tag: expandable green, terminating orange, failed red, unknown grey.
std::array<double, 3> colourOf(Tag tag);
/// Returns the points of a space, coloured by their tags: all points, or only those that a cut
/// shows.
std::vector<LatticeDot> tagDots(const SpaceTable& space, const std::optional<LatticeCut>& cut);

/// Returns an error bound relative to the force: bound / max(|force|, relative_error_floor).
double relativeError(double bound, double force);

/// The relative error bound at the centre of a cell.
struct CellError {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m
  /// result of relativeError(); NaN if the method gives no bound there
  double relative = 0;
};
/// Evaluates the field at the centres of all cells of the uniform lattice that lie in the ball.
/// Takes a few milliseconds.
std::vector<CellError> cellErrors(const SpaceTable& space, const ForceField& field);

/// Ends of the colour scale of errors: a tenth of usual_force_error, and ten times that error. They
/// are fixed, so that a colour always has the same meaning.
inline constexpr double lowest_error = 0.1 * usual_force_error;
inline constexpr double highest_error = 10 * usual_force_error;
/// Returns the position of a relative error on the colour scale, 0 to 1. The scale is logarithmic.
double errorPlace(double relative);

/// Returns the cells as dots, coloured by viridis. Cells without a bound are left out.
std::vector<LatticeDot> errorDots(const std::vector<CellError>& errors, double spacing,
                                  const std::optional<LatticeCut>& cut);

}  // namespace palpate
