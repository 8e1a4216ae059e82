#pragma once

#include "viewer/report/error_measures.hpp"
#include "viewer/report/force_way.hpp"

namespace palpate {

/// Picture of a force field in a plane through the rest position: its error bound, with lattice
/// points and errors at held-out solutions. Empty by default. Positions in the plane are (across,
/// up), metres.
struct SliceMap {
  static constexpr int side = 90;  ///< samples along an edge of the square around the ball
  int across = 0, up = 1;          ///< axes that point right and upward in the picture
  double radius = 0;               ///< m
  /// Error bound, N, of side x side samples, from the lowest row upward. NaN outside the ball, and
  /// where the field has no bound.
  std::vector<double> bound;
  /// Nonzero if the eight corners around a sample are solved; side x side samples.
  std::vector<char> covered;
  struct LatticeMark {
    Eigen::Vector2d at;
    Tag tag;
  };
  std::vector<LatticeMark> marks;                     ///< lattice points in the plane
  std::vector<std::array<Eigen::Vector2d, 2>> jumps;  ///< lattice edges whose ends are on different
                                                      ///< branches
  struct ErrorMark {
    Eigen::Vector2d at;
    double error;  ///< N
  };
  std::vector<ErrorMark> errors;  ///< at held-out solutions close to the plane
};

/// Samples the error bound of a field in the plane of two axes, and the field's errors at
/// `held_out`. `space` is the space from which the field was made. Takes about 10 ms.
SliceMap sampleSlice(const ForceField& field, const SpaceTable& space, int across, int up,
                     const std::vector<HeldOutSolution>& held_out);

/// Returns the statistics of the error bound of a field, N, over the points of a grid in the ball
/// of `radius` (m). Points without a bound are left out.
Spread sampleBounds(const ForceField& field, double radius);

/// Samples of the fields of one active node.
struct NodePictures {
  std::size_t node = 0;  ///< index into Report::nodes
  /// Pictures of the planes xy, xz and yz, for the default method on the shown lattice; empty if
  /// that method cannot be made.
  std::vector<SliceMap> slices;
  /// Forces along x, y and z through rest, with all points of the first dataset. The interpolations
  /// are the methods, in the order of Report::methods.
  std::vector<ForceWay> axes;
  /// Forces on at most three paths from rest through held-out solutions, which tellingOnes()
  /// chooses by their errors; on the shown lattice.
  std::vector<ForceWay> ways;
};

/// Samples the pictures of one node. The caller sets NodePictures::node.
///
/// shown: the space on the shown lattice; the slices show the first of `methods` on it, and the
/// paths show all methods. whole: the space with all points of the dataset; the axes show all
/// methods on it. Any thread; takes a few tenths of a second.
NodePictures sampleNode(const SpaceTable& shown, const SpaceTable& whole,
                        const std::vector<std::string>& methods,
                        const std::vector<HeldOutSolution>& held_out);

}  // namespace palpate
