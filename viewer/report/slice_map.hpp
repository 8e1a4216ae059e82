#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "common/space/space_table.hpp"
#include "viewer/fields/force_field.hpp"
#include "viewer/report/references.hpp"

namespace palpate {

/// Colours for positive numbers, logarithmic, from dark blue (small) over green to yellow (large):
/// viridis, which grows lighter evenly and is read by colour-blind people and in grey prints.
class ColourScale {
 public:
  /// Limits are powers of ten around all but the outermost 2 % of the positive, finite values, at
  /// most five decades, the upper ones kept; 1e-3 to 1 when there are none.
  explicit ColourScale(const std::vector<double>& values);

  double lowest() const { return lowest_; }
  double highest() const { return highest_; }
  static constexpr int levels = 25;
  int levelOf(double value) const;  ///< 0..levels-1; values beyond the limits get the nearest
  static std::string colour(int level);
  std::string colourOf(double value) const { return colour(levelOf(value)); }

 private:
  double lowest_ = 1e-3, highest_ = 1;
};

/// An exact solution and the error that was found there, N.
struct MeasuredReference {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  double error = 0;
};

/// What is known in a plane through the rest position; empty by itself.
struct SliceMap {
  static constexpr int side = 90;  ///< samples along an edge of the square around the ball
  int across = 0, up = 1;          ///< axes of the plane: to the right, and upward
  double radius = 0;               ///< m
  std::vector<double>
      bound;  ///< side x side, rows upward, N; NaN outside of the ball or without bound
  std::vector<char> covered;  ///< side x side; not 0 where the eight corners around are solved
  struct LatticeMark {
    Eigen::Vector2d at;
    Tag tag;
  };
  std::vector<LatticeMark> marks;  ///< lattice points in the plane, m
  std::vector<std::array<Eigen::Vector2d, 2>>
      jumps;                                  ///< lattice edges in the plane between branches, m
  std::vector<MeasuredReference> references;  ///< those close to the plane
};

/// Samples the error bound of `field`. References nearer to the plane than `thickness` are shown in
/// it.
SliceMap sampleSlice(const ForceField& field, const SpaceTable& space, int across, int up,
                     const std::vector<MeasuredReference>& references, double thickness);

/// The map as an <svg> element.
std::string svgOf(const SliceMap& map, const ColourScale& scale);

/// The colours with their numbers, newtons, and what the marks mean, as HTML.
std::string legendOf(const ColourScale& scale);

}  // namespace palpate
