#include "viewer/fields/point_blend.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <map>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"

namespace palpate {
namespace {

/// Number of solved points from which a ghost is extrapolated. This many points span three
/// dimensions even if they form a flat rim.
constexpr std::ptrdiff_t most_sources = 20;

/// Returns the slots of `solved` that are nearest to a ghost (a slot without a solution of its
/// own), nearest first. Leaves out slots that are not on the same branch as the first slot.
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

/// Returns the shares of a ghost in ascending order of rows. `solved`: all solved slots, in
/// ascending order.
std::vector<PointShare> continuedFrom(std::span<const std::int32_t> solved,
                                      const CellBranches& data, std::int32_t ghost) {
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
  // Minimizes the sum of (factor / closeness)^2, so that far slots contribute only if near slots do
  // not suffice.
  const Eigen::MatrixXd weighted = conditions * closeness.asDiagonal();
  const Eigen::VectorXd factors =
      closeness.cwiseProduct(weighted.completeOrthogonalDecomposition().solve(target));
  constexpr double most = 6;  // largest sum of the factors' magnitudes; at a rim it is 1 to 3
  const auto shareOf = [&](std::int32_t slot, double factor) {
    return PointShare{
        static_cast<std::int32_t>(std::ranges::lower_bound(solved, slot) - solved.begin()), factor};
  };
  if (!((conditions * factors - target).norm() < 1e-9 && factors.cwiseAbs().sum() <= most))
    return {shareOf(slots.front(), 1)};
  std::vector<PointShare> shares;
  for (Eigen::Index i = 0; i < n; ++i) shares.push_back(shareOf(slots[at(i)], factors[i]));
  std::ranges::sort(shares, {}, &PointShare::row);
  return shares;
}

/// Interpolates between the shares of a leaf's corners, which must be known.
std::vector<PointShare> sharesIn(const CellTree& tree, const LeafPlace& place,
                                 const std::vector<std::vector<PointShare>>& of_slots) {
  std::map<std::int32_t, double> sum;
  const std::array<double, 8> weights = trilinearWeights(place.local);
  for (std::size_t c = 0; c < 8; ++c)
    for (const PointShare& share : of_slots[at(tree.corners(place.leaf)[c])])
      if (weights[c] != 0) sum[share.row] += weights[c] * share.factor;
  std::vector<PointShare> shares;
  for (const auto& [row, factor] : sum) shares.push_back({row, factor});
  return shares;
}

}  // namespace

PointBlend::PointBlend(const SpaceTable& space)
    : PointBlend(CellBranches(space), space.points.size()) {}

PointBlend::PointBlend(const CellBranches& data, std::size_t all_points)
    : tree_(data.tree), all_points_(all_points), shares_(tree_.slots().size()) {
  const std::vector<CellSlot>& slots = tree_.slots();
  std::vector<std::int32_t> solved;
  for (std::int32_t s = 0; s < std::ssize(slots); ++s) {
    if (slots[at(s)].kind != SlotKind::solved) continue;
    shares_[at(s)] = {{static_cast<std::int32_t>(solved.size()), 1}};
    solved.push_back(s);
    points_.push_back(slots[at(s)].number);
  }
  if (solved.empty())
    throw failure("no corner of any cell was solved, so there is nothing to interpolate");
  for (std::int32_t s = 0; s < std::ssize(slots); ++s)
    if (slots[at(s)].kind == SlotKind::ghost) shares_[at(s)] = continuedFrom(solved, data, s);
  // Hanging slots are filled coarse to fine, so the corners of the coarser leaf are known.
  fillHanging(tree_, shares_, [this](std::int32_t leaf, const Eigen::Vector3d& local) {
    return sharesIn(tree_, {leaf, local}, shares_);
  });
}

PointRows PointBlend::rowsOf(std::span<const float> values, std::size_t components) const {
  const std::size_t width = values.size() / all_points_;
  if (width == 0 || width % components != 0 || values.size() != width * all_points_)
    throw failure("{} values are not a multiple of {} per node for {} lattice points",
                  values.size(), components, all_points_);
  PointRows rows(std::ssize(points_), static_cast<Eigen::Index>(width));
  for (Eigen::Index n = 0; n < rows.rows(); ++n)
    rows.row(n) = Eigen::Map<const Eigen::RowVectorXf>(values.data() + at(points_[at(n)]) * width,
                                                       rows.cols());
  return rows;
}

LeafPlace PointBlend::leafAt(const Eigen::Vector3d& displacement) const noexcept {
  const LeafPlace place = tree_.find(displacement);
  return place.leaf >= 0 ? place : tree_.find(nearestInBall(displacement, tree_.radius()));
}

std::vector<PointShare> PointBlend::sharesAt(const Eigen::Vector3d& displacement) const {
  const LeafPlace place = leafAt(displacement);
  PALPATE_ASSERT(place.leaf >= 0, "the cells must cover the whole ball of displacements");
  return sharesIn(tree_, place, shares_);
}

}  // namespace palpate
