#include "viewer/fields/cell_field.hpp"

#include <algorithm>

namespace palpate {
namespace {

/// Returns the tri-linear interpolant of `Rows` values per slot at a place in a leaf. Column 0 is
/// the value; columns 1 to 3 are the derivatives along the axes of a leaf with unit edges.
template <int Rows, class Node>
Eigen::Matrix<double, Rows, 4> trilinearJet(const LeafCorners& corners,
                                            const Eigen::Vector3d& local, Node node) {
  using Column = Eigen::Matrix<double, Rows, 1>;
  const double x = local.x(), y = local.y(), z = local.z();
  Column low[2], dx[2], dy[2];  // on the lower and the upper face along z
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

}  // namespace

CellField::CellField(std::string_view name, const CellData& data, Limit limit)
    : name_(name), tree_(data.tree), region_(data), limit_(limit), nodes_(data.equilibria.size()) {
  PALPATE_ASSERT(data.support.size() == nodes_.size() && tree_.slots().size() == nodes_.size(),
                 "each corner of the cells must have a force and coverage");
  for (std::size_t s = 0; s < nodes_.size(); ++s)
    nodes_[s] << data.equilibria[s].force, data.support[s];
  // All corners of a leaf with an inconsistent edge get coverage 0, not only the ends of the edge
  // (slotCoverage).
  for (const std::int32_t leaf : data.leavesWith(data.inconsistent))
    for (const std::int32_t slot : tree_.corners(leaf)) nodes_[at(slot)][3] = 0;
  fillHangingTrilinearly(tree_, nodes_);
  setFlags(data.leavesWith(limit == Limit::force ? data.suspect : data.inconsistent));
  if (!flags_.empty()) setSpread();
}

void CellField::setFlags(const std::vector<std::int32_t>& leaves) {
  // If no leaf needs the limiter, flags_ stays empty and the limiter costs nothing.
  if (leaves.empty()) return;
  flags_.assign(nodes_.size(), 0);
  for (const std::int32_t leaf : leaves)
    for (const std::int32_t slot : tree_.corners(leaf)) flags_[at(slot)] = 1;
  fillHangingTrilinearly(tree_, flags_);
}

void CellField::setSpread() {
  spread_.assign(tree_.leaves().size(), -1);
  for (std::size_t leaf = 0; leaf < spread_.size(); ++leaf) {
    const LeafCorners& corners = tree_.corners(static_cast<std::int32_t>(leaf));
    if (std::ranges::all_of(corners, [this](std::int32_t s) { return flags_[at(s)] == 0; }))
      continue;
    for (const std::int32_t a : corners)
      for (const std::int32_t b : corners)
        spread_[leaf] = std::max(spread_[leaf], (nodes_[at(a)] - nodes_[at(b)]).head<3>().norm());
  }
}

ForceSample CellField::evaluate(const Eigen::Vector3d& displacement) const noexcept {
  return answerTo(
      displacement, tree_.radius(), region_.leastRadius(),
      [this](const Eigen::Vector3d& unit) { return region_.along(DirectionWeights(unit)); },
      [this](const Eigen::Vector3d& p) { return inRegion(p); },
      [this](const RegionEdge& edge, const Eigen::Vector3d& unit, double depth) {
        return continuedBeyond(inRegion(edge.radius * unit), edge, unit, depth);
      });
}

ForceSample CellField::inRegion(const Eigen::Vector3d& displacement) const noexcept {
  const LeafPlace place = tree_.find(displacement);
  if (place.leaf < 0) return {};
  ForceSample sample = sampleAt(place);
  sample.inside = !tree_.unsupported(place.leaf);
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
