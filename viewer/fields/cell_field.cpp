#include "viewer/fields/cell_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/index.hpp"
#include "viewer/fields/slot_equilibria.hpp"

namespace palpate {
namespace {

/// Tri-linear interpolant of nodal values in a leaf.
template <class Value>
Value trilinear(const LeafCorners& corners, const Eigen::Vector3d& local,
                const std::vector<Value>& values) {
  const std::array<double, 8> weights = trilinearWeights(local);
  Value sum = weights[0] * values[at(corners[0])];
  for (std::size_t c = 1; c < 8; ++c) sum += weights[c] * values[at(corners[c])];
  return sum;
}

/// Value (column 0) and derivatives along the axes in a leaf with unit edges (columns 1 to 3).
template <int Rows, class Node>
Eigen::Matrix<double, Rows, 4> trilinearJet(const LeafCorners& corners,
                                            const Eigen::Vector3d& local, Node node) {
  using Column = Eigen::Matrix<double, Rows, 1>;
  const double x = local.x(), y = local.y(), z = local.z();
  Column low[2], dx[2], dy[2];  // at the lower and upper face along z
  for (std::size_t k = 0; k < 2; ++k) {
    const Column& a = node(corners[4 * k]);
    const Column& b = node(corners[4 * k + 1]);
    const Column& c = node(corners[4 * k + 2]);
    const Column& d = node(corners[4 * k + 3]);
    const Column front = a + x * (b - a), back = c + x * (d - c);
    low[k] = front + y * (back - front);
    dx[k] = (1 - y) * (b - a) + y * (d - c);
    dy[k] = back - front;
  }
  Eigen::Matrix<double, Rows, 4> jet;
  jet.col(0) = low[0] + z * (low[1] - low[0]);
  jet.col(1) = dx[0] + z * (dx[1] - dx[0]);
  jet.col(2) = dy[0] + z * (dy[1] - dy[0]);
  jet.col(3) = low[1] - low[0];
  return jet;
}

bool contains(const std::vector<LatticeEdge>& edges, std::int32_t a, std::int32_t b) {
  return std::binary_search(edges.begin(), edges.end(),
                            LatticeEdge{std::min(a, b), std::max(a, b)});
}

}  // namespace

CellData::CellData(const SpaceTable& space)
    : tree(space),
      inconsistent(inconsistentEdges(space)),
      suspect(suspectEdges(space)),
      equilibria(slotEquilibria(tree, space, inconsistent)),
      support(slotCoverage(tree, inconsistent)),
      divisions(space.lattice.divisions()) {
  for (const CellSlot& slot : tree.slots())
    numbers.push_back(space.lattice.indexOf(slot.point).value_or(-1));
}

std::int32_t CellData::slotAt(const LatticePoint& point) const {
  const std::vector<CellSlot>& slots = tree.slots();
  const auto found =
      std::lower_bound(slots.begin(), slots.end(), point,
                       [](const CellSlot& slot, const LatticePoint& p) { return slot.point < p; });
  if (found == slots.end() || found->point != point) return -1;
  return static_cast<std::int32_t>(found - slots.begin());
}

bool CellData::isInconsistent(std::int32_t a, std::int32_t b) const {
  return contains(inconsistent, numbers[at(a)], numbers[at(b)]);
}

std::vector<std::int32_t> CellData::leavesWith(const std::vector<LatticeEdge>& edges) const {
  std::vector<std::int32_t> found;
  if (edges.empty()) return found;
  for (std::int32_t leaf = 0; leaf < static_cast<std::int32_t>(tree.leaves().size()); ++leaf) {
    const LeafCorners& corners = tree.corners(leaf);
    bool any = false;
    for (std::size_t c = 0; c < 8; ++c)
      for (const std::size_t axis : {1, 2, 4})
        any = any || ((c & axis) == 0 &&
                      contains(edges, numbers[at(corners[c])], numbers[at(corners[c | axis])]));
    if (any) found.push_back(leaf);
  }
  return found;
}

CellField::CellField(const CellData& data, Limit limit) : tree_(data.tree), limit_(limit) {
  nodes_.reserve(data.equilibria.size());
  for (std::size_t s = 0; s < data.equilibria.size(); ++s) {
    nodes_.emplace_back();
    nodes_.back() << data.equilibria[s].force, data.support[s];
  }
  for (const std::int32_t leaf : data.leavesWith(data.inconsistent))
    for (const std::int32_t slot : tree_.corners(leaf)) nodes_[at(slot)][3] = 0;
  fillHanging(tree_, nodes_,
              [this](std::int32_t leaf, const Eigen::Vector3d& local) -> Eigen::Vector4d {
                return trilinear(tree_.corners(leaf), local, nodes_);
              });
  setFlags(data.leavesWith(limit == Limit::force ? data.suspect : data.inconsistent));
  if (!flags_.empty()) setSpread();
}

void CellField::setFlags(const std::vector<std::int32_t>& leaves) {
  if (leaves.empty()) return;
  flags_.assign(nodes_.size(), 0);
  for (const std::int32_t leaf : leaves)
    for (const std::int32_t slot : tree_.corners(leaf)) flags_[at(slot)] = 1;
  fillHanging(tree_, flags_, [this](std::int32_t leaf, const Eigen::Vector3d& local) {
    return trilinear(tree_.corners(leaf), local, flags_);
  });
}

void CellField::setSpread() {
  const auto leaves = static_cast<std::int32_t>(tree_.leaves().size());
  spread_.assign(tree_.leaves().size(), -1);
  for (std::int32_t leaf = 0; leaf < leaves; ++leaf) {
    const LeafCorners& corners = tree_.corners(leaf);
    if (std::all_of(corners.begin(), corners.end(),
                    [this](std::int32_t s) { return flags_[at(s)] == 0; }))
      continue;
    for (const std::int32_t a : corners)
      for (const std::int32_t b : corners)
        spread_[at(leaf)] =
            std::max(spread_[at(leaf)], (nodes_[at(a)] - nodes_[at(b)]).head<3>().norm());
  }
}

ForceSample CellField::evaluate(const Eigen::Vector3d& displacement) const noexcept {
  LeafPlace place = tree_.find(displacement);
  if (place.leaf >= 0) {
    ForceSample sample = sampleAt(place);
    sample.inside = !tree_.unsupported(place.leaf);
    return sample;
  }
  if (displacement.array().isNaN().any()) return {};
  const Eigen::Vector3d nearest = nearestInBall(displacement, tree_.radius());
  place = tree_.find(nearest);
  if (place.leaf < 0) return {};
  ForceSample sample = sampleAt(place);
  sample.energy = std::numeric_limits<double>::quiet_NaN();
  sample.error_bound += sample.stiffness.norm() * (displacement - nearest).stableNorm();
  // The derivative of radius * displacement / |displacement|.
  const Eigen::Vector3d outwards = nearest / tree_.radius();
  sample.stiffness -= sample.stiffness * outwards * outwards.transpose();
  sample.stiffness *= tree_.radius() / displacement.stableNorm();
  return sample;
}

ForceSample CellField::sampleAt(const LeafPlace& place) const noexcept {
  const Eigen::Matrix4d jet = trilinearJet<4>(
      tree_.corners(place.leaf), place.local,
      [this](std::int32_t slot) -> const Eigen::Vector4d& { return nodes_[at(slot)]; });
  ForceSample sample;
  sample.coverage = std::clamp(jet(3, 0), 0.0, 1.0);
  sample.force = jet.col(0).head<3>();
  sample.stiffness = jet.topRightCorner<3, 3>() / tree_.edge(place.leaf);
  if (spread_.empty() || spread_[at(place.leaf)] < 0) {
    interpolate(place.leaf, place.local, sample);
    return sample;
  }
  const ForceSample linear = sample;
  interpolate(place.leaf, place.local, sample);
  limit(place, linear, sample);
  return sample;
}

void CellField::limit(const LeafPlace& place, const ForceSample& linear,
                      ForceSample& sample) const noexcept {
  const auto flag = trilinearJet<1>(
      tree_.corners(place.leaf), place.local,
      [this](std::int32_t slot) { return Eigen::Matrix<double, 1, 1>(flags_[at(slot)]); });
  const double weight = flag(0, 0);
  sample.error_bound += weight * spread_[at(place.leaf)];
  if (limit_ == Limit::bound) return;
  if (weight == 1) {
    sample.force = linear.force;
    sample.stiffness = linear.stiffness;
  } else {
    const Eigen::Vector3d change = linear.force - sample.force;
    sample.force += weight * change;
    sample.stiffness += weight * (linear.stiffness - sample.stiffness);
    sample.stiffness += change * flag.rightCols<3>() / tree_.edge(place.leaf);
  }
  if (weight > 0) sample.energy = std::numeric_limits<double>::quiet_NaN();
}

}  // namespace palpate
