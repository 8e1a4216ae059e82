#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "common/space/space_table.hpp"
#include "viewer/fields/force_field.hpp"
#include "viewer/fields/relative_error.hpp"

namespace palpate {

/// A point in a configuration space with its colour.
struct LatticeDot {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m
  std::array<double, 3> colour = {0, 0, 0};                ///< red, green, blue, 0 to 255
};

/// A plane perpendicular to an axis; keeps points closer to it than half a spacing.
struct LatticeCut {
  int axis = 2;       ///< 0, 1, 2
  double offset = 0;  ///< m
  bool operator==(const LatticeCut&) const = default;
};

/// Returns the colour of a tag: expandable green, terminating orange, failed red, unknown grey.
std::array<double, 3> colourOf(Tag tag);
/// Returns the points of a space, all or only those in a cut, coloured by tag.
std::vector<LatticeDot> tagDots(const SpaceTable& space, const std::optional<LatticeCut>& cut);

/// Returns an error bound relative to the force: bound / max(|force|, relative_error_floor).
double relativeError(double bound, double force);

/// Relative error bound at the centre of a cell.
struct CellError {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m
  /// relativeError; NaN: the method gives no bound there.
  double relative = 0;
};
/// Evaluates the field at the centres of all cells of the uniform lattice that lie in the ball.
/// Takes some milliseconds.
std::vector<CellError> cellErrors(const SpaceTable& space, const ForceField& field);

/// Ends of the error colour scale: a tenth and ten times usual_force_error. They are fixed, so no
/// outlier changes the meaning of a colour.
inline constexpr double lowest_error = 0.1 * usual_force_error;
inline constexpr double highest_error = 10 * usual_force_error;
/// Returns the place of a relative error on the colour scale, 0 to 1, logarithmic.
double errorPlace(double relative);

/// Returns the cells coloured by viridis; leaves out cells without a bound.
std::vector<LatticeDot> errorDots(const std::vector<CellError>& errors, double spacing,
                                  const std::optional<LatticeCut>& cut);

}  // namespace palpate
