#include "viewer/fields/slot_terms.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <map>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"

namespace palpate {
namespace {

/// Solved points that a ghost is continued from: enough to span the space beside a flat rim too.
constexpr std::ptrdiff_t most_sources = 20;

/// The nearest of the `solved` slots, nearest first, without those on another branch than the
/// first.
std::vector<std::int32_t> sourcesOf(std::span<const std::int32_t> solved, const CellBranches& data,
                                    std::int32_t ghost) {
  const LatticePoint& center = data.tree.slots()[at(ghost)].point;
  std::vector<std::pair<std::int64_t, std::int32_t>> by_distance;
  by_distance.reserve(solved.size());
  for (const std::int32_t slot : solved) {
    LatticePoint step = data.tree.slots()[at(slot)].point;
    for (std::size_t axis = 0; axis < 3; ++axis) step[axis] -= center[axis];
    by_distance.emplace_back(squaredNorm(step), slot);
  }
  const auto end = by_distance.begin() + std::min(std::ssize(by_distance), most_sources);
  std::ranges::partial_sort(by_distance, end);
  std::vector<std::int32_t> slots;
  for (auto found = by_distance.begin(); found != end; ++found)
    if (!data.isInconsistent(by_distance.front().second, found->second))
      slots.push_back(found->second);
  return slots;
}

/// Of slots that hang, coarse to fine: the terms of the corners of their leaf must be known.
std::vector<SlotTerm> hangingTerms(const CellTree& tree, const CellSlot& hanging,
                                   const std::vector<std::vector<SlotTerm>>& terms) {
  std::map<std::int32_t, double> sum;
  const std::array<double, 8> weights = trilinearWeights(hanging.local);
  for (std::size_t c = 0; c < 8; ++c)
    for (const SlotTerm& term : terms[at(tree.corners(hanging.leaf)[c])])
      if (weights[c] != 0) sum[term.slot] += weights[c] * term.factor;
  std::vector<SlotTerm> made;
  for (const auto& [slot, factor] : sum) made.push_back({slot, factor});
  return made;
}

}  // namespace

std::vector<SlotTerm> continuedFrom(std::span<const std::int32_t> solved, const CellBranches& data,
                                    std::int32_t ghost) {
  PALPATE_ASSERT(!solved.empty(), "a tree of cells has a solved corner");
  const std::vector<std::int32_t> slots = sourcesOf(solved, data, ghost);
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
  std::vector<SlotTerm> terms;
  for (Eigen::Index i = 0; i < n; ++i) terms.push_back({slots[at(i)], factors[i]});
  return terms;
}

std::vector<std::vector<SlotTerm>> solvedTerms(const CellBranches& data) {
  const std::vector<CellSlot>& slots = data.tree.slots();
  std::vector<std::vector<SlotTerm>> terms(slots.size());
  std::vector<std::int32_t> solved;
  for (std::int32_t s = 0; s < std::ssize(slots); ++s) {
    if (slots[at(s)].kind != SlotKind::solved) continue;
    solved.push_back(s);
    terms[at(s)] = {{s, 1}};
  }
  if (solved.empty())
    throw failure("no corner of a cell was solved, so there is nothing to continue");
  for (std::int32_t s = 0; s < std::ssize(slots); ++s) {
    if (slots[at(s)].kind != SlotKind::ghost) continue;
    terms[at(s)] = continuedFrom(solved, data, s);
    std::ranges::sort(terms[at(s)], {}, &SlotTerm::slot);
  }
  for (const std::int32_t s : data.tree.hangingSlots())
    terms[at(s)] = hangingTerms(data.tree, slots[at(s)], terms);
  return terms;
}

}  // namespace palpate
