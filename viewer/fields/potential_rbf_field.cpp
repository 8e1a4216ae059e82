#include "viewer/fields/potential_rbf_field.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

// Measured on livers (docs/measurements.md). More points in a patch cost time with little gain in
// accuracy.
constexpr double root_edge = 2;  ///< spacings; of the largest cells of the octree
constexpr double reach = 1.1;    ///< radius of a patch, in half diagonals of its cell
constexpr std::size_t most_global_points = 128;
constexpr std::size_t most_patch_points = 64, fewest_patch_points = 24;
constexpr int deepest_level = 12;  ///< ends the division at points that coincide

/// Wendland's (1 - t)^4 (4 t + 1) of t = |p - centre| / radius, with its derivatives with respect
/// to p.
Jet weightAt(const Eigen::Vector3d& step, double radius) noexcept {
  Jet weight;
  const Eigen::Vector3d t_vector = step / radius;
  const double t = t_vector.norm();
  if (!(t < 1)) return weight;
  const double s = 1 - t;
  weight.value = s * s * s * s * (4 * t + 1);
  weight.gradient = -20 * s * s * s / radius * t_vector;
  weight.hessian = -20 * s * s * s / (radius * radius) * Eigen::Matrix3d::Identity();
  if (t > 0) weight.hessian += 60 * s * s / (t * radius * radius) * t_vector * t_vector.transpose();
  return weight;
}

}  // namespace

struct PotentialRbfField::Points {
  std::vector<Eigen::Vector3d> position;  ///< in spacings
  std::vector<Jet> jet;                   ///< J, with derivatives by spacings

  explicit Points(const SpaceTable& space) {
    const double h = space.lattice.spacing();
    for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
      if (!isSolved(space.points[n].tag)) continue;
      const Equilibrium& point = space.points[n].equilibrium;
      position.emplace_back(space.lattice.displacement(n) / h);
      jet.push_back({point.energy, -h * point.force,
                     -0.5 * h * h * (point.stiffness + point.stiffness.transpose())});
    }
  }

  std::size_t countWithin(const Eigen::Vector3d& centre, double radius) const {
    return static_cast<std::size_t>(std::count_if(
        position.begin(), position.end(),
        [&](const Eigen::Vector3d& p) { return (p - centre).squaredNorm() <= radius * radius; }));
  }

  /// Those within the radius, and the nearest ones up to `fewest`; in the order of the lattice.
  std::vector<std::size_t> around(const Eigen::Vector3d& centre, double radius,
                                  std::size_t fewest) const {
    std::vector<std::pair<double, std::size_t>> by_distance;
    for (std::size_t n = 0; n < position.size(); ++n)
      by_distance.emplace_back((position[n] - centre).squaredNorm(), n);
    std::sort(by_distance.begin(), by_distance.end());
    std::vector<std::size_t> chosen;
    for (const auto& [squared, n] : by_distance)
      if (chosen.size() < fewest || squared <= radius * radius) chosen.push_back(n);
    std::sort(chosen.begin(), chosen.end());
    return chosen;
  }
};

PotentialRbfField::PotentialRbfField(const SpaceTable& space, const RbfKernels& kernels)
    : CellField(CellData(space)), kernels_(kernels) {
  const Points points(space);
  const double extent = tree().radius() / tree().spacing();  // of the ball, in spacings
  if (points.position.size() <= most_global_points) {
    roots_ = 1;
    cells_.push_back({Eigen::Vector3d::Zero(), extent});
    Patch patch{Eigen::Vector3d::Zero(), 1e9, 1, HermiteRbf(points.position, points.jet)};
    patches_.push_back(patch);
  } else {
    // An odd number of roots: the one in the middle has its centre at the origin.
    roots_ = 2 * static_cast<std::int32_t>(std::ceil((extent - root_edge / 2) / root_edge)) + 1;
    for (std::int32_t i = 0; i < roots_; ++i)
      for (std::int32_t j = 0; j < roots_; ++j)
        for (std::int32_t k = 0; k < roots_; ++k)
          cells_.push_back({root_edge * (Eigen::Vector3d(i, j, k) -
                                         Eigen::Vector3d::Constant(0.5 * (roots_ - 1))),
                            root_edge / 2});
    for (std::int32_t root = 0; root < roots_ * roots_ * roots_; ++root) divide(root, 0, points);
  }
  findNear();
}

void PotentialRbfField::divide(std::int32_t cell, int level, const Points& points) {
  const Eigen::Vector3d centre = cells_[cell].centre;
  const double half = cells_[cell].half, ball = reach * std::sqrt(3.0) * half;
  const Eigen::Vector3d nearest = (centre.cwiseAbs().array() - half).max(0).matrix();
  if (nearest.norm() > tree().radius() / tree().spacing() + 1e-9)
    return;  // nothing of it is in the workspace
  if (points.countWithin(centre, ball) <= most_patch_points || level == deepest_level) {
    addPatch(cells_[cell], points);
    return;
  }
  const auto first = static_cast<std::int32_t>(cells_.size());
  cells_[cell].children = first;
  for (int c = 0; c < 8; ++c)
    cells_.push_back(
        {centre + half / 2 * Eigen::Vector3d((c & 1) ? 1 : -1, (c & 2) ? 1 : -1, (c & 4) ? 1 : -1),
         half / 2});
  for (int c = 0; c < 8; ++c) divide(first + c, level + 1, points);
}

void PotentialRbfField::addPatch(const Cell& cell, const Points& points) {
  Patch patch{cell.centre, reach * std::sqrt(3.0) * cell.half, 2 * cell.half / root_edge, {}};
  std::vector<Eigen::Vector3d> positions;
  std::vector<Jet> jets;
  for (const std::size_t n : points.around(cell.centre, patch.radius, fewest_patch_points)) {
    const Jet& jet = points.jet[n];
    positions.emplace_back((points.position[n] - cell.centre) / patch.unit);
    jets.push_back({jet.value, patch.unit * jet.gradient, patch.unit * patch.unit * jet.hessian});
  }
  patch.energy = HermiteRbf(positions, jets);
  patches_.push_back(std::move(patch));
}

void PotentialRbfField::findNear() {
  for (Cell& cell : cells_) {
    if (cell.children >= 0) continue;
    cell.first = static_cast<std::int32_t>(near_.size());
    for (std::size_t n = 0; n < patches_.size(); ++n) {
      const Eigen::Vector3d gap =
          ((patches_[n].centre - cell.centre).cwiseAbs().array() - cell.half).max(0).matrix();
      if (gap.norm() < patches_[n].radius) near_.push_back(static_cast<std::int32_t>(n));
    }
    cell.last = static_cast<std::int32_t>(near_.size());
  }
}

const PotentialRbfField::Cell& PotentialRbfField::leafAt(const Eigen::Vector3d& p) const noexcept {
  const Cell& corner = cells_.front();
  std::int32_t number = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double place = std::floor((p[axis] - corner.centre[axis]) / (2 * corner.half) + 0.5);
    number = number * roots_ + std::clamp(static_cast<std::int32_t>(place), 0, roots_ - 1);
  }
  while (cells_[number].children >= 0) {
    const Cell& cell = cells_[number];
    number = cell.children + (p.x() > cell.centre.x() ? 1 : 0) + (p.y() > cell.centre.y() ? 2 : 0) +
             (p.z() > cell.centre.z() ? 4 : 0);
  }
  return cells_[number];
}

Jet PotentialRbfField::blend(const Cell& leaf, const Eigen::Vector3d& p) const noexcept {
  if (patches_.size() == 1) return patches_.front().energy.evaluate(kernels_, p);
  Jet sum, weights;
  for (std::int32_t n = leaf.first; n < leaf.last; ++n) {
    const Patch& patch = patches_[near_[n]];
    const Eigen::Vector3d step = p - patch.centre;
    if (step.squaredNorm() >= patch.radius * patch.radius) continue;
    const Jet w = weightAt(step, patch.radius);
    Jet e = patch.energy.evaluate(kernels_, step / patch.unit);
    e.gradient /= patch.unit;
    e.hessian /= patch.unit * patch.unit;
    const Eigen::Matrix3d mixed = w.gradient * e.gradient.transpose();
    sum.value += w.value * e.value;
    sum.gradient += w.value * e.gradient + e.value * w.gradient;
    sum.hessian += w.value * e.hessian + mixed + mixed.transpose() + e.value * w.hessian;
    weights.value += w.value;
    weights.gradient += w.gradient;
    weights.hessian += w.hessian;
  }
  Jet energy;
  energy.value = sum.value / weights.value;
  energy.gradient = (sum.gradient - energy.value * weights.gradient) / weights.value;
  const Eigen::Matrix3d mixed = energy.gradient * weights.gradient.transpose();
  energy.hessian =
      (sum.hessian - mixed - mixed.transpose() - energy.value * weights.hessian) / weights.value;
  return energy;
}

void PotentialRbfField::interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                                    ForceSample& sample) const noexcept {
  const double spacing = tree().spacing();
  const Eigen::Vector3d p =
      (tree().displacement(tree().corners(leaf)[0]) + tree().edge(leaf) * local) / spacing;
  const Jet energy = blend(leafAt(p), p);
  sample.energy = energy.value;
  sample.force = -energy.gradient / spacing;
  sample.stiffness = -energy.hessian / (spacing * spacing);
}

}  // namespace palpate
