#pragma once

#include "viewer/report/error_measures.hpp"
#include "viewer/report/force_way.hpp"

namespace palpate {

/// What is known of a force field in a plane through the rest position; empty by itself. Positions
/// are (across, up), metres.
struct SliceMap {
  static constexpr int side = 90;  ///< samples along an edge of the square around the ball
  int across = 0, up = 1;          ///< axes of the plane: to the right, and upward
  double radius = 0;               ///< m
  /// side x side, rows upward: the error bound, N; NaN outside of the ball or without bound.
  std::vector<double> bound;
  /// side x side: not 0 where the eight corners around are solved.
  std::vector<char> covered;
  struct LatticeMark {
    Eigen::Vector2d at;
    Tag tag;
  };
  std::vector<LatticeMark> marks;                     ///< lattice points in the plane
  std::vector<std::array<Eigen::Vector2d, 2>> jumps;  ///< lattice edges between branches
  struct ErrorMark {
    Eigen::Vector2d at;
    double error;  ///< N
  };
  std::vector<ErrorMark> errors;  ///< at held-out solutions close to the plane

  /// Index of a sample in `bound` and `covered`.
  static std::size_t sampleAt(int row, int column) {
    return static_cast<std::size_t>(row) * side + static_cast<std::size_t>(column);
  }
};

/// Samples the error bound of `field`, made of `space`, in the plane of two axes, and its error at
/// `held_out`. Some 10 ms.
SliceMap sampleSlice(const ForceField& field, const SpaceTable& space, int across, int up,
                     const std::vector<HeldOutSolution>& held_out);

/// Where the error bound of `field` lies, N, all over the ball of `radius` (m): at the points of a
/// grid, where there is a bound.
Spread sampleBounds(const ForceField& field, double radius);

/// Fields of one active node, sampled.
struct NodePictures {
  std::size_t node = 0;  ///< index into Report::nodes
  /// Planes xy, xz and yz, the default method on the shown lattice; empty when it cannot be made.
  std::vector<SliceMap> slices;
  /// Through rest along x, y and z, in the first dataset as it is; interpolations are the methods,
  /// in the order of Report::methods.
  std::vector<ForceWay> axes;
  /// From rest through held-out solutions of telling errors, on the shown lattice; at most three.
  std::vector<ForceWay> ways;
};

/// Samples the first of `methods` in the planes of `shown`, the space as it is on the shown
/// lattice, and all of them on ways of it and along the axes of `whole`, as it is in the dataset.
/// Does not set NodePictures::node. Any thread; some tenths of a second.
NodePictures sampleNode(const SpaceTable& shown, const SpaceTable& whole,
                        const std::vector<std::string>& methods,
                        const std::vector<HeldOutSolution>& held_out);

}  // namespace palpate
