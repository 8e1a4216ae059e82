#include "viewer/fields/displacement_field.hpp"

#include <Eigen/QR>
#include <algorithm>

#include "common/base/cpu_family.hpp"
#include "common/base/error.hpp"

namespace palpate {
namespace {

/// Solved points that a ghost is continued from: enough to span the space beside a flat rim too.
constexpr std::size_t sources = 20;

/// A multiple of a slot's row.
struct Term {
  std::int32_t slot;
  double factor;
};

/// Solved slots by distance from a ghost, nearest first, without those on another branch than the
/// nearest.
std::vector<std::int32_t> nearestSolved(const CellBranches& data, std::int32_t ghost) {
  const LatticePoint& center = data.tree.slots()[at(ghost)].point;
  const auto distance = [&](std::int32_t slot) {
    LatticePoint step = data.tree.slots()[at(slot)].point;
    for (std::size_t axis = 0; axis < 3; ++axis) step[axis] -= center[axis];
    return squaredNorm(step);
  };
  std::vector<std::int32_t> solved;
  for (std::int32_t s = 0; s < std::ssize(data.tree.slots()); ++s)
    if (data.tree.slots()[at(s)].kind == SlotKind::solved) solved.push_back(s);
  if (solved.empty())
    throw failure("no corner of a cell was solved, so there is no shape to continue");
  const std::size_t kept = std::min(sources, solved.size());
  std::ranges::partial_sort(solved, solved.begin() + kept, {},
                            [&](std::int32_t slot) { return std::pair(distance(slot), slot); });
  solved.resize(kept);
  const std::int32_t nearest = solved.front();
  std::erase_if(solved, [&](std::int32_t slot) { return data.isInconsistent(nearest, slot); });
  return solved;
}

/// Factors that sum to one and continue linear functions exactly, near slots weighing more; the
/// nearest alone where the slots do not span the space or would be blown up.
std::vector<Term> linearContinuation(const CellBranches& data, std::int32_t ghost) {
  const std::vector<std::int32_t> slots = nearestSolved(data, ghost);
  const auto n = static_cast<Eigen::Index>(slots.size());
  Eigen::MatrixXd conditions(4, n);
  Eigen::VectorXd closeness(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d offset =
        (data.tree.displacement(slots[at(i)]) - data.tree.displacement(ghost)) /
        data.tree.spacing();
    conditions.col(i) << 1, offset;
    closeness[i] = 1 / offset.norm();
  }
  const Eigen::Vector4d target(1, 0, 0, 0);
  // The least sum of squared factors over closeness: far slots take part where near ones do not do.
  const Eigen::MatrixXd weighted = conditions * closeness.asDiagonal();
  const Eigen::VectorXd factors =
      closeness.cwiseProduct(weighted.completeOrthogonalDecomposition().solve(target));
  constexpr double most = 6;  // sum of the magnitudes: 1 to 3 at a rim
  if (!((conditions * factors - target).norm() < 1e-9 && factors.cwiseAbs().sum() <= most))
    return {{slots.front(), 1}};
  std::vector<Term> terms;
  for (Eigen::Index i = 0; i < n; ++i) terms.push_back({slots[at(i)], factors[i]});
  return terms;
}

/// out = sum of factors[n] * rows[n].
PALPATE_PER_CPU_FAMILY void combineRows(const std::array<const float*, 8>& rows,
                                        const std::array<float, 8>& factors, float* out,
                                        std::size_t size) noexcept {
  for (std::size_t i = 0; i < size; ++i) {
    float sum = factors[0] * rows[0][i] + factors[1] * rows[1][i] + factors[2] * rows[2][i] +
                factors[3] * rows[3][i];
    sum += factors[4] * rows[4][i] + factors[5] * rows[5][i] + factors[6] * rows[6][i] +
           factors[7] * rows[7][i];
    out[i] = sum;
  }
}

}  // namespace

DisplacementField::DisplacementField(const SpaceTable& space, std::span<const float> displacements)
    : DisplacementField(CellBranches(space), space.points.size(), displacements) {}

DisplacementField::DisplacementField(const CellBranches& data, std::size_t points,
                                     std::span<const float> displacements)
    : tree_(data.tree), row_(displacements.size() / points) {
  if (row_ == 0 || row_ % 3 != 0 || displacements.size() != row_ * points)
    throw failure("{} displacement values do not make three per node for {} lattice points",
                  displacements.size(), points);
  // Solved rows first, then what is continued from them, then what hangs between both.
  rows_.assign(tree_.slots().size() * row_, 0);
  const auto slots = static_cast<std::int32_t>(tree_.slots().size());
  for (std::int32_t s = 0; s < slots; ++s)
    if (const CellSlot& slot = tree_.slots()[at(s)]; slot.kind == SlotKind::solved)
      std::ranges::copy(displacements.subspan(at(slot.number) * row_, row_), row(s));
  for (std::int32_t s = 0; s < slots; ++s)
    if (tree_.slots()[at(s)].kind == SlotKind::ghost) continueGhost(data, s);
  for (const std::int32_t s : tree_.hangingSlots()) {
    const CellSlot& slot = tree_.slots()[at(s)];
    evaluateIn({slot.leaf, slot.local}, row(s));
  }
}

void DisplacementField::continueGhost(const CellBranches& data, std::int32_t ghost) {
  for (const Term& term : linearContinuation(data, ghost))
    for (std::size_t i = 0; i < row_; ++i)
      row(ghost)[i] += static_cast<float>(term.factor) * row(term.slot)[i];
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
  evaluateIn(place, out.data());
  return in_ball && !tree_.unsupported(place.leaf);
}

void DisplacementField::evaluateIn(const LeafPlace& place, float* out) const noexcept {
  const std::array<double, 8> weights = trilinearWeights(place.local);
  std::array<const float*, 8> rows;
  std::array<float, 8> factors;
  for (std::size_t c = 0; c < 8; ++c) {
    rows[c] = rows_.data() + at(tree_.corners(place.leaf)[c]) * row_;
    factors[c] = static_cast<float>(weights[c]);
  }
  combineRows(rows, factors, out, row_);
}

}  // namespace palpate
