#include "viewer/fields/displacement_field.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <numeric>

#include "common/base/error.hpp"

namespace palpate {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// Solved points that a ghost is continued from: enough to span the space beside a flat rim too.
constexpr std::size_t sources = 20;

/// A multiple of a slot's row.
struct Term {
  std::int32_t slot;
  double factor;
};

/// Solved slots by distance from a ghost, nearest first, without those on another branch than the
/// nearest.
std::vector<std::int32_t> nearestSolved(const CellData& data, std::int32_t ghost,
                                        std::size_t count) {
  const LatticePoint& center = data.tree.slots()[at(ghost)].point;
  const auto distance = [&](std::int32_t slot) {
    LatticePoint step = data.tree.slots()[at(slot)].point;
    for (std::size_t axis = 0; axis < 3; ++axis) step[axis] -= center[axis];
    return squaredNorm(step);
  };
  std::vector<std::int32_t> solved;
  for (std::size_t s = 0; s < data.tree.slots().size(); ++s)
    if (data.tree.slots()[s].kind == SlotKind::solved)
      solved.push_back(static_cast<std::int32_t>(s));
  const std::size_t kept = std::min(count, solved.size());
  std::partial_sort(solved.begin(), solved.begin() + static_cast<std::ptrdiff_t>(kept),
                    solved.end(), [&](std::int32_t a, std::int32_t b) {
                      return std::pair(distance(a), a) < std::pair(distance(b), b);
                    });
  solved.resize(kept);
  const std::int32_t nearest = solved.front();
  std::erase_if(solved, [&](std::int32_t slot) { return data.isInconsistent(nearest, slot); });
  return solved;
}

/// Factors that sum to one and continue linear functions exactly, near slots weighing more; the
/// nearest alone where the slots do not span the space or would be blown up.
std::vector<Term> linearContinuation(const CellData& data, std::int32_t ghost) {
  const std::vector<std::int32_t> slots = nearestSolved(data, ghost, sources);
  const auto n = static_cast<Eigen::Index>(slots.size());
  Eigen::MatrixXd conditions(4, n);
  Eigen::VectorXd closeness(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d offset = (data.tree.displacement(slots[static_cast<std::size_t>(i)]) -
                                    data.tree.displacement(ghost)) /
                                   data.tree.spacing();
    conditions.col(i) << 1, offset;
    closeness[i] = 1 / offset.norm();
  }
  const Eigen::Vector4d target(1, 0, 0, 0);
  const Eigen::MatrixXd weighted = conditions * closeness.asDiagonal();
  const Eigen::VectorXd factors =
      closeness.cwiseProduct(weighted.completeOrthogonalDecomposition().solve(target));
  constexpr double most = 6;  // sum of the magnitudes: 1 to 3 at a rim
  if (!((conditions * factors - target).norm() < 1e-9 && factors.cwiseAbs().sum() <= most))
    return {{slots.front(), 1}};
  std::vector<Term> terms;
  for (Eigen::Index i = 0; i < n; ++i)
    terms.push_back({slots[static_cast<std::size_t>(i)], factors[i]});
  return terms;
}

/// out += or = sum of factors[n] * rows[n]; eight rows at a time keep the sums in registers.
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void combineRows(
    const std::array<const float*, 8>& rows, const std::array<float, 8>& factors, bool add,
    float* out, std::size_t size) noexcept {
  for (std::size_t i = 0; i < size; ++i) {
    float sum = factors[0] * rows[0][i] + factors[1] * rows[1][i] + factors[2] * rows[2][i] +
                factors[3] * rows[3][i];
    sum += factors[4] * rows[4][i] + factors[5] * rows[5][i] + factors[6] * rows[6][i] +
           factors[7] * rows[7][i];
    out[i] = add ? out[i] + sum : sum;
  }
}

/// Factors of the corners' values (0) and slopes along x, y, z (1 to 3).
using HermiteWeights = std::array<std::array<double, 8>, 4>;

/// Tensor product cubic Hermite basis. The mixed derivative of two axes at a corner is taken as the
/// mean of the differences of both slopes to the next corners of the same face, so that what a face
/// says depends on its corners alone; the triple one as zero.
HermiteWeights hermiteWeights(const Eigen::Vector3d& local, double edge) noexcept {
  std::array<std::array<double, 2>, 3> value, slope;  // [axis][end]
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double t = local[static_cast<Eigen::Index>(axis)], s = 1 - t;
    value[axis] = {s * s * (1 + 2 * t), t * t * (1 + 2 * s)};
    slope[axis] = {edge * t * s * s, -edge * s * t * t};
  }
  HermiteWeights weights{};
  for (std::size_t c = 0; c < 8; ++c) {
    const std::array<std::size_t, 3> end = {c & 1, c >> 1 & 1, c >> 2 & 1};
    weights[0][c] = value[0][end[0]] * value[1][end[1]] * value[2][end[2]];
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t b = (a + 1) % 3, d = (a + 2) % 3;
      weights[a + 1][c] += slope[a][end[a]] * value[b][end[b]] * value[d][end[d]];
      const double mixed = 0.5 / edge * slope[a][end[a]] * slope[b][end[b]] * value[d][end[d]];
      const double along_a = end[a] == 0 ? mixed : -mixed, along_b = end[b] == 0 ? mixed : -mixed;
      weights[a + 1][c ^ std::size_t{1} << b] += along_b;
      weights[a + 1][c] -= along_b;
      weights[b + 1][c ^ std::size_t{1} << a] += along_a;
      weights[b + 1][c] -= along_a;
    }
  }
  return weights;
}

}  // namespace

DisplacementField::DisplacementField(const SpaceTable& space, std::span<const float> displacements,
                                     std::span<const float> tangents)
    : DisplacementField(CellData(space), space.points.size(), displacements, tangents) {}

DisplacementField::DisplacementField(const CellData& data, std::size_t points,
                                     std::span<const float> displacements,
                                     std::span<const float> tangents)
    : tree_(data.tree), row_(displacements.size() / points), kinds_(tangents.empty() ? 1 : 4) {
  if (row_ == 0 || row_ % 3 != 0 || displacements.size() != row_ * points)
    throw failure("{} displacement values do not make three per node for {} lattice points",
                  displacements.size(), points);
  if (kinds_ > 1 && tangents.size() != 3 * displacements.size())
    throw failure(
        "{} tangent values do not belong to {} displacement values: three times as many do",
        tangents.size(), displacements.size());
  rows_.assign(tree_.slots().size() * kinds_ * row_, 0);
  copySolved(displacements, tangents);
  continueGhosts(data);
  for (const std::int32_t slot : tree_.hangingSlots()) {
    const CellSlot& hanging = tree_.slots()[at(slot)];
    evaluateLinear(tree_.corners(hanging.leaf), hanging.local, row(slot, 0).data());
  }
  if (kinds_ > 1) setFlags(data);
}

void DisplacementField::copySolved(std::span<const float> displacements,
                                   std::span<const float> tangents) {
  for (std::size_t s = 0; s < tree_.slots().size(); ++s) {
    const CellSlot& slot = tree_.slots()[s];
    if (slot.kind != SlotKind::solved) continue;
    const auto index = static_cast<std::int32_t>(s);
    std::ranges::copy(displacements.subspan(at(slot.number) * row_, row_), row(index, 0).begin());
    for (std::size_t kind = 1; kind < kinds_; ++kind)
      std::ranges::copy(tangents.subspan((3 * at(slot.number) + kind - 1) * row_, row_),
                        row(index, kind).begin());
  }
}

void DisplacementField::continueGhosts(const CellData& data) {
  for (std::size_t s = 0; s < tree_.slots().size(); ++s) {
    if (tree_.slots()[s].kind != SlotKind::ghost) continue;
    const auto ghost = static_cast<std::int32_t>(s);
    if (kinds_ == 1) {
      for (const Term& term : linearContinuation(data, ghost))
        for (std::size_t i = 0; i < row_; ++i)
          row(ghost, 0)[i] += static_cast<float>(term.factor) * row(term.slot, 0)[i];
      continue;
    }
    const std::int32_t nearest = nearestSolved(data, ghost, 1).front();
    for (std::size_t kind = 0; kind < kinds_; ++kind)
      std::ranges::copy(row(nearest, kind), row(ghost, kind).begin());
    const Eigen::Vector3f step =
        (tree_.displacement(ghost) - tree_.displacement(nearest)).cast<float>();
    for (std::size_t kind = 1; kind < kinds_; ++kind)
      for (std::size_t i = 0; i < row_; ++i)
        row(ghost, 0)[i] += step[static_cast<Eigen::Index>(kind) - 1] * row(nearest, kind)[i];
  }
}

/// Flags all corners of leaves with an inconsistent edge, and of leaves on both sides of a change
/// of level.
void DisplacementField::setFlags(const CellData& data) {
  flags_.assign(tree_.slots().size(), 0);
  const auto flag = [&](std::int32_t leaf) {
    for (const std::int32_t slot : tree_.corners(leaf)) flags_[at(slot)] = 1;
  };
  for (const std::int32_t leaf : data.leavesWith(data.inconsistent)) flag(leaf);
  for (std::size_t leaf = 0; leaf < tree_.leaves().size(); ++leaf) {
    const auto index = static_cast<std::int32_t>(leaf);
    for (const std::int32_t slot : tree_.corners(index))
      if (tree_.slots()[at(slot)].kind == SlotKind::hanging) {
        flag(index);
        flag(tree_.slots()[at(slot)].leaf);
      }
  }
  for (const std::int32_t slot : tree_.hangingSlots()) flags_[at(slot)] = 1;
}

bool DisplacementField::evaluate(const Eigen::Vector3d& displacement,
                                 std::span<float> out) const noexcept {
  LeafPlace place = tree_.find(displacement);
  const bool in_ball = place.leaf >= 0;
  if (!in_ball) place = tree_.find(nearestInBall(displacement, tree_.radius()));
  if (displacement.array().isNaN().any() || place.leaf < 0) {
    std::ranges::fill(out, 0.0f);
    return false;
  }
  if (kinds_ == 1)
    evaluateLinear(tree_.corners(place.leaf), place.local, out.data());
  else
    evaluateHermite(place, out.data());
  return in_ball && !tree_.unsupported(place.leaf);
}

void DisplacementField::evaluateLinear(const LeafCorners& corners, const Eigen::Vector3d& local,
                                       float* out) const noexcept {
  const std::array<double, 8> weights = trilinearWeights(local);
  std::array<const float*, 8> rows;
  std::array<float, 8> factors;
  for (std::size_t c = 0; c < 8; ++c) {
    rows[c] = rows_.data() + at(corners[c]) * kinds_ * row_;
    factors[c] = static_cast<float>(weights[c]);
  }
  combineRows(rows, factors, false, out, row_);
}

void DisplacementField::evaluateHermite(const LeafPlace& place, float* out) const noexcept {
  const LeafCorners& corners = tree_.corners(place.leaf);
  const std::array<double, 8> linear = trilinearWeights(place.local);
  double flag = 0;
  for (std::size_t c = 0; c < 8; ++c)
    flag += linear[c] * static_cast<double>(flags_[at(corners[c])]);
  if (flag >= 1) return evaluateLinear(corners, place.local, out);

  const HermiteWeights weights = hermiteWeights(place.local, tree_.edge(place.leaf));
  for (std::size_t kind = 0; kind < 4; ++kind) {
    std::array<const float*, 8> rows;
    std::array<float, 8> factors;
    for (std::size_t c = 0; c < 8; ++c) {
      rows[c] = rows_.data() + (at(corners[c]) * kinds_ + kind) * row_;
      factors[c] =
          static_cast<float>((1 - flag) * weights[kind][c] + (kind == 0 ? flag * linear[c] : 0));
    }
    combineRows(rows, factors, kind > 0, out, row_);
  }
}

}  // namespace palpate
