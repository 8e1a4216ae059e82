#include "viewer/fields/displacement_field.hpp"

#include <Eigen/QR>
#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/cpu_family.hpp"
#include "common/base/error.hpp"

namespace palpate {
namespace {

/// Solved points that a ghost is continued from: enough to span the space beside a flat rim too.
constexpr std::ptrdiff_t sources = 20;

/// A multiple of a slot's row.
struct Term {
  std::int32_t slot;
  double factor;
};

/// The nearest of the `solved` slots by distance from a ghost, nearest first, without those on
/// another branch than the nearest.
std::vector<std::int32_t> nearestOf(std::span<const std::int32_t> solved, const CellBranches& data,
                                    std::int32_t ghost) {
  const LatticePoint& center = data.tree.slots()[at(ghost)].point;
  std::vector<std::pair<std::int64_t, std::int32_t>> by_distance;
  by_distance.reserve(solved.size());
  for (const std::int32_t slot : solved) {
    LatticePoint step = data.tree.slots()[at(slot)].point;
    for (std::size_t axis = 0; axis < 3; ++axis) step[axis] -= center[axis];
    by_distance.emplace_back(squaredNorm(step), slot);
  }
  const auto end = by_distance.begin() + std::min(std::ssize(by_distance), sources);
  std::ranges::partial_sort(by_distance, end);
  std::vector<std::int32_t> slots;
  for (auto found = by_distance.begin(); found != end; ++found)
    if (!data.isInconsistent(by_distance.front().second, found->second))
      slots.push_back(found->second);
  return slots;
}

/// Factors that sum to one and continue linear functions exactly, near slots weighing more; the
/// nearest alone where the slots do not span the space or would be blown up.
std::vector<Term> linearContinuation(std::span<const std::int32_t> solved, const CellBranches& data,
                                     std::int32_t ghost) {
  const std::vector<std::int32_t> slots = nearestOf(solved, data, ghost);
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

/// Rows that are added at once: few passes over `out`, and no more pointers than registers.
constexpr std::size_t rows_at_once = 4;

/// out += sum of factors[n] * rows[n].
PALPATE_PER_CPU_FAMILY void addRows(const std::array<const float*, rows_at_once>& rows,
                                    const std::array<float, rows_at_once>& factors, float* out,
                                    std::size_t size) noexcept {
  for (std::size_t i = 0; i < size; ++i)
    out[i] += factors[0] * rows[0][i] + factors[1] * rows[1][i] + factors[2] * rows[2][i] +
              factors[3] * rows[3][i];
}

}  // namespace

DisplacementField::DisplacementField(const SpaceTable& space, std::span<const float> displacements)
    : DisplacementField(CellBranches(space), space.points.size(), displacements) {}

DisplacementField::DisplacementField(const CellBranches& data, std::size_t points,
                                     std::span<const float> displacements)
    : tree_(data.tree) {
  const std::size_t row = displacements.size() / points;
  if (row == 0 || row % 3 != 0 || displacements.size() != row * points)
    throw failure("{} displacement values do not make three per node for {} lattice points",
                  displacements.size(), points);
  const std::vector<CellSlot>& slots = tree_.slots();
  std::vector<std::int32_t> solved;
  for (std::int32_t s = 0; s < std::ssize(slots); ++s)
    if (slots[at(s)].kind == SlotKind::solved) solved.push_back(s);
  if (solved.empty())
    throw failure("no corner of a cell was solved, so there is no shape to continue");
  const auto width = static_cast<Eigen::Index>(row);
  ShapeRows shapes(std::ssize(solved), width);
  for (Eigen::Index n = 0; n < shapes.rows(); ++n) {
    const float* from = displacements.data() + at(slots[at(solved[at(n)])].number) * row;
    shapes.row(n) = Eigen::Map<const Eigen::RowVectorXf>(from, width);
  }
  modes_ = modesOf(shapes, static_cast<float>(largest_shape_error * tree_.radius()));
  // Solved slots first, then what is continued from them, then what hangs between both.
  Eigen::MatrixXd shares = Eigen::MatrixXd::Zero(std::ssize(slots), modes_.rows());
  const ShapeRows of_solved = shapes * modes_.transpose();
  for (Eigen::Index n = 0; n < shapes.rows(); ++n)
    shares.row(solved[at(n)]) = of_solved.row(n).cast<double>();
  for (std::int32_t s = 0; s < std::ssize(slots); ++s)
    if (slots[at(s)].kind == SlotKind::ghost)
      for (const Term& term : linearContinuation(solved, data, s))
        shares.row(s) += term.factor * shares.row(term.slot);
  for (const std::int32_t s : tree_.hangingSlots()) {
    const CellSlot& slot = slots[at(s)];
    const std::array<double, 8> weights = trilinearWeights(slot.local);
    for (std::size_t c = 0; c < 8; ++c)
      shares.row(s) += weights[c] * shares.row(tree_.corners(slot.leaf)[c]);
  }
  shares_ = shares.cast<float>();
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
  evaluateIn(place, out);
  return in_ball && !tree_.unsupported(place.leaf);
}

void DisplacementField::evaluateIn(const LeafPlace& place, std::span<float> out) const noexcept {
  const std::array<double, 8> weights = trilinearWeights(place.local);
  std::ranges::fill(out, 0.0f);
  // The last few are filled up with the first mode, times nothing.
  for (std::size_t first = 0; first < modeCount(); first += rows_at_once) {
    std::array<const float*, rows_at_once> rows;
    std::array<float, rows_at_once> factors{};
    rows.fill(modes_.data());
    for (std::size_t n = 0; n < rows_at_once && first + n < modeCount(); ++n) {
      const auto mode = static_cast<Eigen::Index>(first + n);
      rows[n] = modes_.row(mode).data();
      for (std::size_t c = 0; c < 8; ++c)
        factors[n] += static_cast<float>(weights[c]) * shares_(tree_.corners(place.leaf)[c], mode);
    }
    addRows(rows, factors, out.data(), out.size());
  }
}

}  // namespace palpate
