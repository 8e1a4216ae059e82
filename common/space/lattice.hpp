#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <vector>

namespace palpate {

/// Integer coordinates (i, j, k) of a lattice point; its displacement is spacing / divisions * (i,
/// j, k).
using LatticePoint = std::array<std::int32_t, 3>;

/// i^2 + j^2 + k^2.
std::int64_t squaredNorm(const LatticePoint& point);

/// Two lattice points that are joined by an edge of a leaf cell.
struct LatticeEdge {
  std::int32_t a = -1, b = -1;  ///< lattice numbers, a < b
  auto operator<=>(const LatticeEdge&) const = default;
};

/// The part of a ball that a contact which only pushes reaches: displacements p with
/// p . outward <= pull |p| that are within `width` of the line along outward. By default all of it.
struct PushedPart {
  Eigen::Vector3d outward = Eigen::Vector3d::Zero();       ///< unit; zero: all of the ball
  double pull = 1;                                         ///< -1 to 1; 1: all of the ball
  double width = std::numeric_limits<double>::infinity();  ///< m, > 0
  bool operator==(const PushedPart&) const = default;
  /// With room: metres that p may lie outside of it.
  bool contains(const Eigen::Vector3d& p, double room = 0) const {
    const double along = p.dot(outward);
    return along <= pull * p.norm() + room && (p - along * outward).norm() <= width + room;
  }
};

/// The positions of one configuration space: the uniform lattice of the closed workspace ball
/// (paper, Eq. 11, with the origin), and the points that refinement added to it.
///
/// Membership of the ball is decided in integers, i^2+j^2+k^2 <= (radius/spacing)^2: with r = 100
/// mm, spacing 20, 100/7, 10, 100/15 mm these are 515, 1419, 4169, 14147 points, where a
/// floating-point test drops some that lie exactly on the sphere. "100/7 mm" may be written 14.3
/// mm: a spacing within 0.2 % of radius/n, n integer, is taken as exactly radius/n.
///
/// The lattice may be of a part of the ball only (PushedPart): then the points of the rest are left
/// out, and the others numbered in the same order.
///
/// Coordinates count in `divisions` parts of the spacing, a power of two, so that refined points
/// and probes have integer coordinates too, and the same displacement, to the last bit, as in a
/// lattice without divisions. Uniform points are numbered 0..uniformSize()-1 by (squared norm, i,
/// j, k), the origin is number 0; added ones follow in the order in which they were added. The
/// numbering is part of the dataset. Any thread may read while nobody adds.
class Lattice {
 public:
  /// No point at all.
  Lattice() = default;
  /// radius and spacing in metres, as check() demands them. 10 million points take about 0.2 GB and
  /// a second.
  /// Of a part of the ball: its uniform points, and those within half a spacing of it.
  Lattice(double radius, double spacing, std::int32_t divisions = 1, const PushedPart& part = {});

  /// The origin alone, for positions that are added.
  static Lattice ofRest(double radius, double spacing, std::int32_t divisions);

  /// Error (bad input) unless both are > 0, radius >= spacing, and the lattice has no more than 10
  /// million points. Costs nothing.
  static void check(double radius, double spacing);

  double radius() const { return radius_; }              ///< metres
  double spacing() const { return spacing_; }            ///< metres, after the rounding above
  std::int32_t divisions() const { return divisions_; }  ///< coordinates per spacing
  double unit() const { return spacing_ / divisions_; }  ///< metres per coordinate
  std::int32_t size() const { return static_cast<std::int32_t>(points_.size()); }
  std::int32_t uniformSize() const { return uniform_size_; }
  const LatticePoint& point(std::int32_t index) const { return points_[index]; }
  /// Number of a point; nothing when it is none.
  std::optional<std::int32_t> indexOf(const LatticePoint& point) const;
  /// Displacement of point `index`, metres.
  Eigen::Vector3d displacement(std::int32_t index) const { return displacementOf(points_[index]); }
  /// The same of any coordinates.
  Eigen::Vector3d displacementOf(const LatticePoint& point) const;

  /// The up to 26 uniform points that differ from the uniform point `index` by at most one spacing
  /// in each coordinate, in the order in which they are tried as parents: shortest transition
  /// first, then nearest to the origin, then lexicographic (i, j, k).
  std::vector<std::int32_t> neighbours(std::int32_t index) const;

  /// Its first `count` points, all uniform ones at least.
  Lattice first(std::int32_t count) const;

  /// Appends a point. Error when it is there already.
  void add(const LatticePoint& point);

 private:
  std::optional<std::size_t> placeInCube(const LatticePoint& point) const;

  double radius_ = 0;
  double spacing_ = 0;
  std::int32_t divisions_ = 1;
  std::int32_t extent_ = -1;  ///< largest coordinate of a uniform point, in spacings
  std::int32_t uniform_size_ = 0;
  std::vector<LatticePoint> points_;
  std::vector<std::int32_t> index_of_;  ///< (2 extent + 1)^3 cube, -1 where there is no point
  std::map<LatticePoint, std::int32_t> added_;  ///< those that are not in the cube
};

/// The number of the lattice point that people name by its coordinates in spacings; refined ones
/// have fractions. Error (bad input), naming the bounds, when it is not in the lattice.
std::int32_t pointNamed(const Lattice& lattice, const Eigen::Vector3d& in_spacings);

/// A cube of the octree over a lattice. Its edge is divisions >> level coordinates: one spacing at
/// level 0, half of it at level 1, and so on. At level 0 `lowest` is a multiple of the divisions.
struct LatticeCell {
  LatticePoint lowest = {0, 0, 0};  ///< the corner with the smallest coordinates
  std::int32_t level = 0;
  auto operator<=>(const LatticeCell&) const = default;
};

/// The order of SpaceTable::splits: by level, then by lowest corner.
bool coarserFirst(const LatticeCell& a, const LatticeCell& b);

/// Whether a cell is among those that were split, which are in the order of coarserFirst.
bool isSplit(const std::vector<LatticeCell>& splits, const LatticeCell& cell);

/// The cell of the next coarser level around a cell of level 1 or more.
LatticeCell parentOf(const LatticeCell& cell, std::int32_t divisions);

/// A cell that reaches less deep into the ball, in radii, does not count as reaching into it: so
/// round-off does not decide about cells that touch the sphere from outside.
inline constexpr double shallow_reach = 1e-10;

/// Whether a cell reaches into the ball of the lattice.
bool reachesIntoBall(const Lattice& lattice, const LatticeCell& cell);

/// Cells of level 0 on each side of the origin, per axis, that may reach into the ball.
std::int32_t cellsPerRadius(const Lattice& lattice);

}  // namespace palpate
