#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <vector>

namespace palpate {

/// Integer coordinates of a lattice point. Its displacement is spacing / divisions * (i, j, k).
using LatticePoint = std::array<std::int32_t, 3>;

/// Returns i^2 + j^2 + k^2.
std::int64_t squaredNorm(const LatticePoint& point);

/// Lattice numbers of the points around a lattice point, at most 26. Needs no heap memory.
using Neighbours = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 1, Eigen::ColMajor, 26, 1>;

/// An edge of a leaf cell, given by its two lattice points.
struct LatticeEdge {
  std::int32_t a = -1, b = -1;  ///< lattice numbers, a < b
  auto operator<=>(const LatticeEdge&) const = default;
};

/// Returns whether one of the sorted `edges` joins the points with the numbers a and b.
inline bool contains(const std::vector<LatticeEdge>& edges, std::int32_t a, std::int32_t b) {
  return std::ranges::binary_search(edges, LatticeEdge{std::min(a, b), std::max(a, b)});
}

/// The steps from a lattice point to its 26 neighbours, in lexicographic order.
inline constexpr std::array<LatticePoint, 26> neighbor_steps = [] {
  std::array<LatticePoint, 26> all = {};
  std::size_t n = 0;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k)
        if (i != 0 || j != 0 || k != 0) all[n++] = {i, j, k};
  return all;
}();

/// Returns point n of the sequence of Roberts (2018). The first points of this sequence, however
/// many, fill the unit cube evenly. Coordinate k = 1, 2, 3 is the fractional part of 0.5 + n / g^k,
/// with g^4 = g + 1.
Eigen::Vector3d evenlySpread(std::int64_t n);

/// Returns the point of the unit sphere with the coordinate z (-1 to 1), at the angle of `turn`
/// full turns (0 to 1) around the z axis. This map preserves areas up to a factor (Archimedes).
Eigen::Vector3d onSphere(double z, double turn);

/// The part of the workspace ball that a contact reaches if it can only push. These are the
/// displacements p with p . outward <= pull |p| that lie within `width` of the line along
/// `outward`. The default is the whole ball.
struct PushedPart {
  Eigen::Vector3d outward = Eigen::Vector3d::Zero();       ///< unit vector; zero for the whole ball
  double pull = 1;                                         ///< -1 to 1; 1 for the whole ball
  double width = std::numeric_limits<double>::infinity();  ///< m, > 0
  bool operator==(const PushedPart&) const = default;
  /// Returns whether p (metres) lies in this part of the ball, or outside it by at most about
  /// `room` metres.
  bool contains(const Eigen::Vector3d& p, double room = 0) const {
    const double along = p.dot(outward);
    return along <= pull * p.norm() + room && (p - along * outward).norm() <= width + room;
  }
};

/// The positions of one configuration space: the uniform lattice of the closed workspace ball
/// (paper, Eq. 11, including the origin) and the points that refinement added.
///
/// Whether a point lies in the ball is decided in integers: i^2+j^2+k^2 <= (radius/spacing)^2. A
/// floating-point test would lose some points that lie exactly on the sphere. For a radius of 100
/// mm, spacings of 20, 100/7, 10 and 100/15 mm give 515, 1419, 4169 and 14147 points. A spacing
/// within 0.2 % of radius/n, with n an integer, is rounded to radius/n, so that users may write
/// 100/7 mm as 14.3 mm.
///
/// The lattice may cover only a part of the ball (PushedPart). Points farther than half a spacing
/// outside that part are left out, and the others are numbered in the same order.
///
/// Coordinates are integers in units of spacing / divisions, with divisions a power of two, so that
/// points of refined cells and probes have integer coordinates too. Displacements of uniform points
/// are the same, bit for bit, for any number of divisions.
///
/// Uniform points have the numbers 0..uniformSize()-1, sorted by (squared norm, i, j, k); number 0
/// is the origin. Added points follow in the order in which they were added. The numbering is part
/// of the dataset. Any thread may read as long as no thread adds points.
class Lattice {
 public:
  /// Makes a lattice without points.
  Lattice() = default;
  /// Takes radius and spacing in metres; check() gives their limits. The lattice holds the uniform
  /// points in `part` and up to half a spacing outside it. 10 million points take about 0.2 GB of
  /// memory and a second to make.
  Lattice(double radius, double spacing, std::int32_t divisions = 1, const PushedPart& part = {});

  /// Makes a lattice with the origin as its only uniform point. Other points can be added.
  static Lattice ofRest(double radius, double spacing, std::int32_t divisions);

  /// Error (bad input) unless radius and spacing are > 0, radius >= spacing, and the lattice would
  /// have at most 10 million points. Takes constant time: it estimates the number of points.
  static void check(double radius, double spacing);

  double radius() const { return radius_; }              ///< metres
  double spacing() const { return spacing_; }            ///< metres, after the rounding above
  std::int32_t divisions() const { return divisions_; }  ///< coordinate units per spacing
  double unit() const { return spacing_ / divisions_; }  ///< metres per coordinate unit
  std::int32_t size() const { return static_cast<std::int32_t>(points_.size()); }
  std::int32_t uniformSize() const { return uniform_size_; }
  const LatticePoint& point(std::int32_t index) const { return points_[index]; }
  /// Returns the number of a point, or nullopt if it is not in the lattice.
  std::optional<std::int32_t> indexOf(const LatticePoint& point) const;
  /// Displacement of point `index`, metres.
  Eigen::Vector3d displacement(std::int32_t index) const { return displacementOf(points_[index]); }
  /// Displacement at any coordinates, metres; the lattice need not contain them.
  Eigen::Vector3d displacementOf(const LatticePoint& point) const;

  /// Returns the up to 26 uniform points that differ from the uniform point `index` by at most one
  /// spacing per coordinate. They are in the order in which they are tried as starts of a
  /// transition to `index`: sorted by distance to `index`, then by distance to the origin, then by
  /// (i, j, k).
  Neighbours neighbours(std::int32_t index) const;

  /// Returns a copy with only the first `count` points. `count` must be at least uniformSize().
  Lattice first(std::int32_t count) const;

  /// Appends a point. Error if the lattice already has it.
  void add(const LatticePoint& point);

 private:
  std::optional<std::size_t> placeInCube(const LatticePoint& point) const;

  double radius_ = 0;
  double spacing_ = 0;
  std::int32_t divisions_ = 1;
  std::int32_t extent_ = -1;  ///< largest coordinate of a uniform point, in spacings
  std::int32_t uniform_size_ = 0;
  std::vector<LatticePoint> points_;
  /// Lattice numbers in a cube of (2 extent_ + 1)^3 positions; -1 where there is no point.
  std::vector<std::int32_t> index_of_;
  std::map<LatticePoint, std::int32_t> added_;  ///< lattice numbers of the other points
};

/// Returns the number of the lattice point with these coordinates, which a user has given in units
/// of the spacing. They are fractions for points of refined cells. Error (bad input) that gives the
/// bounds if the lattice does not contain the point.
std::int32_t pointNamed(const Lattice& lattice, const Eigen::Vector3d& in_spacings);

/// A cubic cell of the octree over a lattice. Its edge is divisions >> level coordinate units: one
/// spacing at level 0, half a spacing at level 1, and so on. The coordinates of `lowest` are
/// multiples of this edge.
struct LatticeCell {
  LatticePoint lowest = {0, 0, 0};  ///< the corner with the smallest coordinates
  std::int32_t level = 0;
  auto operator<=>(const LatticeCell&) const = default;
};

/// Compares cells by level, then by lowest corner. SpaceTable::splits is sorted in this order.
bool coarserFirst(const LatticeCell& a, const LatticeCell& b);

/// Returns whether `cell` is in `splits`, which is sorted by coarserFirst.
bool isSplit(const std::vector<LatticeCell>& splits, const LatticeCell& cell);

/// Returns the cell of the next coarser level that contains `cell`, which must not be of level 0.
LatticeCell parentOf(const LatticeCell& cell, std::int32_t divisions);

/// Depth inside the ball, in radii, that a part of a cell must exceed for the cell to count as
/// reaching into the ball. This excludes cells that only touch the sphere from outside, despite
/// round-off.
inline constexpr double shallow_reach = 1e-10;

/// Returns whether the cell reaches into the ball of the lattice.
bool reachesIntoBall(const Lattice& lattice, const LatticeCell& cell);

/// Returns the number of level-0 cells, along each axis and on each side of the origin, that may
/// reach into the ball.
std::int32_t cellsPerRadius(const Lattice& lattice);

}  // namespace palpate
