#include "common/space/lattice.hpp"

#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/number_text.hpp"

namespace palpate {
namespace {

constexpr double max_points = 1e7;  // the estimate 4/3 pi ratio^3 is accurate to 0.1 %
/// Relative tolerance for rounded spacings: 14.3 mm stands for 100/7 mm = 14.2857 mm, and 6.667 mm
/// for 100/15 mm.
constexpr double spacing_tolerance = 2e-3;

/// Returns radius / spacing, rounded to an integer if it is within spacing_tolerance of one.
double ratioOf(double radius, double spacing) {
  if (!(std::isfinite(spacing) && spacing > 0))
    throw badInput("workspace.spacing = {} m: must be greater than 0", spacing);
  if (!(std::isfinite(radius) && radius >= spacing))
    throw badInput(
        "workspace.radius = {} m is smaller than workspace.spacing = {} m: the lattice would be "
        "only the origin",
        radius, spacing);
  const double ratio = radius / spacing;
  const double whole = std::round(ratio);
  // Users who write 14.3 mm for 100/7 mm want a lattice that ends on the sphere.
  return std::abs(ratio - whole) <= spacing_tolerance * whole ? whole : ratio;
}

/// Calls visit(point, squared norm) for each lattice point of the ball, in lexicographic order.
template <class Visit>
void forEachPointOfBall(std::int32_t extent, std::int64_t limit, Visit visit) {
  for (std::int32_t i = -extent; i <= extent; ++i)
    for (std::int32_t j = -extent; j <= extent; ++j)
      for (std::int32_t k = -extent; k <= extent; ++k)
        if (const std::int64_t norm = squaredNorm({i, j, k}); norm <= limit)
          visit(LatticePoint{i, j, k}, static_cast<std::size_t>(norm));
}

/// Returns the lattice points of the ball, sorted by (squared norm, i, j, k). Uses a counting sort,
/// because there may be millions of points.
std::vector<LatticePoint> pointsOfBall(std::int32_t extent, std::int64_t limit) {
  std::vector<std::size_t> next(static_cast<std::size_t>(limit) + 2,
                                0);  // per squared norm, index of its next point
  forEachPointOfBall(extent, limit,
                     [&](const LatticePoint&, std::size_t norm) { ++next[norm + 1]; });
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<LatticePoint> points(next.back());
  forEachPointOfBall(extent, limit,
                     [&](const LatticePoint& p, std::size_t norm) { points[next[norm]++] = p; });
  return points;
}

}  // namespace

Eigen::Vector3d evenlySpread(std::int64_t n) {
  constexpr double g = 1.2207440846057596;
  const Eigen::Array3d step(1 / g, 1 / (g * g), 1 / (g * g * g));
  const Eigen::Array3d place = 0.5 + static_cast<double>(n) * step;
  return place - place.floor();
}

Eigen::Vector3d onSphere(double z, double turn) {
  const double r = std::sqrt(1 - z * z), angle = 2 * M_PI * turn;
  return {r * std::cos(angle), r * std::sin(angle), z};
}

std::int64_t squaredNorm(const LatticePoint& p) {
  return std::int64_t{p[0]} * p[0] + std::int64_t{p[1]} * p[1] + std::int64_t{p[2]} * p[2];
}

void Lattice::check(double radius, double spacing) {
  const double ratio = ratioOf(radius, spacing);
  const double expected = 4.0 / 3.0 * M_PI * ratio * ratio * ratio;
  if (expected > max_points)
    throw badInput(
        "workspace.radius / workspace.spacing = {:.4g} makes about {:.3g} lattice points, "
        "more than {:.0e}: choose a larger spacing",
        ratio, expected, max_points);
}

Lattice::Lattice(double radius, double spacing, std::int32_t divisions, const PushedPart& part)
    : radius_(radius), divisions_(divisions) {
  PALPATE_ASSERT(divisions > 0 && (divisions & (divisions - 1)) == 0, "this must be a power of 2");
  check(radius, spacing);
  const double ratio = ratioOf(radius, spacing);
  spacing_ = radius / ratio;
  extent_ = static_cast<std::int32_t>(std::floor(ratio));
  // The margin keeps the points on the sphere if the ratio is an integer up to round-off.
  const auto limit = static_cast<std::int64_t>(std::floor(ratio * ratio * (1 + 1e-12)));

  points_ = pointsOfBall(extent_, limit);
  std::erase_if(points_, [&](const LatticePoint& p) {
    return !part.contains(spacing_ * Eigen::Vector3d(p[0], p[1], p[2]), spacing_ / 2);
  });
  uniform_size_ = size();
  PALPATE_ASSERT(uniform_size_ > 0 && points_.front() == LatticePoint{}, "point 0 must be at rest");
  for (LatticePoint& point : points_)
    for (std::int32_t& coordinate : point) coordinate *= divisions;
  const std::size_t side = 2 * static_cast<std::size_t>(extent_) + 1;
  index_of_.assign(side * side * side, -1);
  for (std::int32_t n = 0; n < size(); ++n) index_of_[*placeInCube(points_[n])] = n;
}

Lattice Lattice::ofRest(double radius, double spacing, std::int32_t divisions) {
  check(radius, spacing);
  Lattice lattice;
  lattice.radius_ = radius;
  lattice.spacing_ = radius / ratioOf(radius, spacing);
  lattice.divisions_ = divisions;
  lattice.extent_ = 0;
  lattice.uniform_size_ = 1;
  lattice.points_ = {{0, 0, 0}};
  lattice.index_of_ = {0};
  return lattice;
}

std::optional<std::size_t> Lattice::placeInCube(const LatticePoint& point) const {
  std::size_t place = 0;
  for (const std::int32_t coordinate : point) {
    const std::int32_t in_spacings = coordinate / divisions_;
    // Division truncates. Multiply back to find out whether the coordinate is a multiple of the
    // divisions.
    if (in_spacings * divisions_ != coordinate || std::abs(in_spacings) > extent_)
      return std::nullopt;
    place = place * (2 * static_cast<std::size_t>(extent_) + 1) +
            static_cast<std::size_t>(in_spacings + extent_);
  }
  return place;
}

std::optional<std::int32_t> Lattice::indexOf(const LatticePoint& point) const {
  if (const auto place = placeInCube(point))
    return index_of_[*place] < 0 ? std::nullopt : std::optional(index_of_[*place]);
  const auto found = added_.find(point);
  return found == added_.end() ? std::nullopt : std::optional(found->second);
}

Eigen::Vector3d Lattice::displacementOf(const LatticePoint& p) const {
  return unit() * Eigen::Vector3d(p[0], p[1], p[2]);
}

void Lattice::add(const LatticePoint& point) {
  if (indexOf(point))
    throw failure("lattice point ({}, {}, {}) is added twice", point[0], point[1], point[2]);
  if (const auto place = placeInCube(point))
    index_of_[*place] = size();
  else
    added_.emplace(point, size());
  points_.push_back(point);
}

Lattice Lattice::first(std::int32_t count) const {
  PALPATE_ASSERT(count >= uniform_size_ && count <= size(), "only added points can be left out");
  Lattice part = *this;
  part.points_.resize(static_cast<std::size_t>(count));
  std::erase_if(part.added_, [count](const auto& added) { return added.second >= count; });
  for (std::int32_t n = count; n < size(); ++n)
    if (const auto place = placeInCube(points_[n])) part.index_of_[*place] = -1;
  return part;
}

Neighbours Lattice::neighbours(std::int32_t index) const {
  PALPATE_ASSERT(index >= 0 && index < uniform_size_, "the point must be of the uniform lattice");
  const LatticePoint& point = points_[index];
  const LatticePoint center = {point[0] / divisions_, point[1] / divisions_, point[2] / divisions_};
  const auto place = static_cast<std::int64_t>(*placeInCube(point));
  const std::int64_t side = 2 * std::int64_t{extent_} + 1;
  const auto isInside = [&](std::int32_t x) { return std::abs(x) <= extent_; };
  // Sort keys of the neighbours found: length of the step, then norm of the neighbour, then
  // coordinates.
  std::array<std::pair<std::int64_t, std::int32_t>, 26> found;
  std::size_t count = 0;
  for (std::size_t s = 0; s < neighbor_steps.size(); ++s) {
    const auto [i, j, k] = neighbor_steps[s];
    if (!isInside(center[0] + i) || !isInside(center[1] + j) || !isInside(center[2] + k)) continue;
    const std::int32_t number =
        index_of_[static_cast<std::size_t>(place + (i * side + j) * side + k)];
    // Skip added points. The plan chooses the parents of those points in another way.
    if (number < 0 || number >= uniform_size_) continue;
    const std::int64_t squared_length = i * i + j * j + k * k;
    // For steps of equal length, the neighbour's norm grows with the dot product of point and step.
    const std::int64_t along =
        std::int64_t{center[0]} * i + std::int64_t{center[1]} * j + std::int64_t{center[2]} * k;
    found[count++] = {(squared_length << 40) + along * 32 + static_cast<std::int64_t>(s), number};
  }
  std::sort(found.begin(), found.begin() + count);
  Neighbours neighbours(static_cast<Eigen::Index>(count));
  for (std::size_t n = 0; n < count; ++n)
    neighbours[static_cast<Eigen::Index>(n)] = found[n].second;
  return neighbours;
}

std::int32_t pointNamed(const Lattice& lattice, const Eigen::Vector3d& in_spacings) {
  const Eigen::Array3d coordinates = lattice.divisions() * in_spacings;
  if ((coordinates.abs() < 1e9).all() && (coordinates == coordinates.round()).all()) {
    const Eigen::Array3i point = coordinates.cast<std::int32_t>();
    if (const auto number = lattice.indexOf({point[0], point[1], point[2]})) return *number;
  }
  throw badInput(
      "({}) is not in the lattice: "
      "it holds the points with i^2 + j^2 + k^2 <= {:.6g} (radius {} m / spacing {} m, "
      "squared){}",
      vectorText(in_spacings, 6), std::pow(lattice.radius() / lattice.spacing(), 2),
      lattice.radius(), lattice.spacing(),
      lattice.size() > lattice.uniformSize()
          ? fmt::format(", and {} refined ones", lattice.size() - lattice.uniformSize())
          : "");
}

bool coarserFirst(const LatticeCell& a, const LatticeCell& b) {
  return std::tie(a.level, a.lowest) < std::tie(b.level, b.lowest);
}

bool isSplit(const std::vector<LatticeCell>& splits, const LatticeCell& cell) {
  return std::ranges::binary_search(splits, cell, coarserFirst);
}

LatticeCell parentOf(const LatticeCell& cell, std::int32_t divisions) {
  PALPATE_ASSERT(cell.level > 0, "cells of level 0 have no parent");
  LatticeCell parent = {cell.lowest, cell.level - 1};
  const std::int32_t edge = divisions >> parent.level;
  // Round down to a multiple of `edge`, also if the coordinate, and with it the remainder, is
  // negative.
  for (std::int32_t& coordinate : parent.lowest) coordinate -= (coordinate % edge + edge) % edge;
  return parent;
}

bool reachesIntoBall(const Lattice& lattice, const LatticeCell& cell) {
  const std::int32_t edge = lattice.divisions() >> cell.level;
  double squared = 0;  // squared distance from the origin to the nearest place of the cell
  for (const std::int32_t low : cell.lowest) {
    const double distance = std::max({low, -(low + edge), 0});
    squared += distance * distance;
  }
  const double limit =
      lattice.radius() / lattice.spacing() * lattice.divisions() * (1 - shallow_reach);
  return squared < limit * limit;
}

std::int32_t cellsPerRadius(const Lattice& lattice) {
  return static_cast<std::int32_t>(
      std::ceil(lattice.radius() / lattice.spacing() * (1 - shallow_reach)));
}

}  // namespace palpate
