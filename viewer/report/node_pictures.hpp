#pragma once

#include "viewer/report/error_measures.hpp"
#include "viewer/report/force_way.hpp"

namespace palpate {

/// Error bound of a force field in a plane through the rest position, with lattice points and
/// errors. Empty by default. Positions are (across, up), metres.
struct SliceMap {
  static constexpr int side = 90;  ///< samples along an edge of the square around the ball
  int across = 0, up = 1;          ///< axes to the right and upward
  double radius = 0;               ///< m
  /// side x side, rows upward: error bound, N; NaN outside the ball or without a bound.
  std::vector<double> bound;
  /// side x side: nonzero if the eight surrounding corners are solved.
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

  /// Returns the index of a sample in `bound` and `covered`.
  static std::size_t sampleAt(int row, int column) {
    return static_cast<std::size_t>(row) * side + static_cast<std::size_t>(column);
  }
};

/// Samples the error bound of `field`, made of `space`, in the plane of two axes, and its errors at
/// `held_out`. Takes about 10 ms.
SliceMap sampleSlice(const ForceField& field, const SpaceTable& space, int across, int up,
                     const std::vector<HeldOutSolution>& held_out);

/// Returns the statistics of the error bound of `field`, N, over the grid points in the ball of
/// `radius` (m) that have a bound.
Spread sampleBounds(const ForceField& field, double radius);

/// Fields of one active node, sampled.
struct NodePictures {
  std::size_t node = 0;  ///< index into Report::nodes
  /// Planes xy, xz and yz, default method on the shown lattice; empty if it cannot be made.
  std::vector<SliceMap> slices;
  /// Along x, y and z through rest, in the first dataset as it is. The interpolations are the
  /// methods, in the order of Report::methods.
  std::vector<ForceWay> axes;
  /// From rest through the held-out solutions of tellingOnes(), on the shown lattice; at most
  /// three.
  std::vector<ForceWay> ways;
};

/// Samples the pictures of one node; does not set NodePictures::node.
///
/// Samples the first of `methods` in the planes of `shown`, the space on the shown lattice. Samples
/// all methods on paths through `shown` and along the axes of `whole`, the space as it is in the
/// dataset. Any thread; takes some tenths of a second.
NodePictures sampleNode(const SpaceTable& shown, const SpaceTable& whole,
                        const std::vector<std::string>& methods,
                        const std::vector<HeldOutSolution>& held_out);

}  // namespace palpate
