#include "viewer/fields/potential_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

// Mismatch that an edge may keep, as a share of the difference between the forces at its ends. Up
// to a share of 0.27, the force of a quintic stays between the forces at the ends. Measured at 9315
// exact solutions (ten nodes of the coarse liver, balls of 100 mm, spacing 20 mm): with 0.1, the
// largest error next to jumps stays near that of tri-linear interpolation. With larger shares, only
// the mean error stays near it.
constexpr double allowed_share = 0.1;
// Number of sweeps. Each sweep multiplies the distance to the minimum by at most about 6/7.
constexpr int sweeps = 100;
// Part of the error bound per weight of failed corners, as a share of the force. Chosen on the
// first four bodies of docs/yardstick.md: of 1135 touches in leaves with a failed corner, the bound
// holds at 91 instead of 57 %.
constexpr double share_at_failed = 10;

/// An edge of a leaf between two slots that are not hanging.
struct CellEdge {
  std::int32_t a, b;
  double length;    ///< metres
  double mismatch;  ///< N, (E_b - E_a + work of the force) / length with the stored energies
  double allowed;   ///< N
};

CellEdge edgeBetween(const CellData& data, std::int32_t a, std::int32_t b) {
  const Equilibrium &low = data.equilibria[at(a)], &high = data.equilibria[at(b)];
  const Eigen::Vector3d step = data.tree.displacement(b) - data.tree.displacement(a);
  const double length = step.norm(), bend = step.dot((high.stiffness - low.stiffness) * step);
  const double work = 0.5 * (low.force + high.force).dot(step) - bend / 12;
  return {.a = a,
          .b = b,
          .length = length,
          .mismatch = (high.energy - low.energy + work) / length,
          .allowed = allowed_share * std::abs((high.force - low.force).dot(step)) / length};
}

/// Computes the corrections of the slots in leaves with an inconsistent edge, from the edges that
/// end in these slots.
class Corrections {
 public:
  explicit Corrections(const CellData& data) : values_(data.tree.slots().size(), 0) {
    for (const std::int32_t leaf : data.leavesWith(data.inconsistent))
      for (const std::int32_t slot : data.tree.corners(leaf))
        if (data.tree.slots()[at(slot)].kind != SlotKind::hanging) edges_[slot];
    if (edges_.empty()) return;
    PALPATE_ASSERT(data.equilibria.size() == values_.size(), "corners must have energy and force");
    for (std::int32_t leaf = 0; leaf < std::ssize(data.tree.leaves()); ++leaf)
      addEdges(data, data.tree.corners(leaf));
  }

  std::vector<double> minimise() && {
    for (int sweep = 0; sweep < sweeps; ++sweep)
      for (const auto& [slot, edges] : edges_) relax(slot, edges);
    return std::move(values_);
  }

 private:
  void addEdges(const CellData& data, const LeafCorners& corners) {
    for (std::size_t c = 0; c < 8; ++c)
      for (const std::size_t axis : {1, 2, 4})
        if ((c & axis) == 0) add(data, corners[c], corners[c | axis]);
  }

  /// Stores an edge only once, although every leaf around the edge adds it.
  void add(const CellData& data, std::int32_t a, std::int32_t b) {
    for (const std::int32_t end : {a, b}) {
      const auto found = edges_.find(end);
      if (found == edges_.end() ||
          data.tree.slots()[at(end == a ? b : a)].kind == SlotKind::hanging)
        continue;
      std::vector<CellEdge>& edges = found->second;
      if (std::ranges::none_of(edges, [&](const CellEdge& e) { return e.a == a && e.b == b; }))
        edges.push_back(edgeBetween(data, a, b));
    }
  }

  /// Sets one correction to the minimum, with all others fixed.
  void relax(std::int32_t slot, const std::vector<CellEdge>& edges) {
    double slope = 0, curvature = 0, shortest = std::numeric_limits<double>::infinity();
    for (const CellEdge& edge : edges) {
      const double force =
          edge.mismatch + (values_[at(edge.b)] - values_[at(edge.a)]) / edge.length;
      const double excess = force - std::clamp(force, -edge.allowed, edge.allowed);
      slope += (edge.b == slot ? excess : -excess) / edge.length;
      curvature += 1 / (edge.length * edge.length);
      shortest = std::min(shortest, edge.length);
    }
    if (edges.empty()) return;
    const double hold = 1 / (shortest * shortest);
    values_[at(slot)] -= (slope + hold * values_[at(slot)]) / (curvature + hold);
  }

  std::map<std::int32_t, std::vector<CellEdge>> edges_;  ///< key: a slot that may be corrected
  std::vector<double> values_;                           ///< J, per slot
};

/// Returns 1 for each slot whose lattice point failed or is not interpolated, else 0.
std::vector<double> failedSlots(const CellData& data) {
  const std::vector<CellSlot>& slots = data.tree.slots();
  std::vector<double> failed(slots.size());
  for (std::size_t s = 0; s < slots.size(); ++s)
    failed[s] = slots[s].kind == SlotKind::ghost && data.numbers[s] >= 0;
  fillHangingTrilinearly(data.tree, failed);
  return failed;
}

}  // namespace

std::vector<double> energyCorrections(const CellData& data) { return Corrections(data).minimise(); }

std::vector<LocalPolynomial> correctedPolynomials(CellData& data, const SpaceTable& space,
                                                  LocalFits& fits) {
  std::vector<LocalPolynomial> polynomials =
      slotPolynomials(data.tree, space, data.inconsistent, std::move(data.ghosts), fits);
  const std::vector<double> corrections = energyCorrections(data);
  PALPATE_ASSERT(corrections.size() == polynomials.size(), "each polynomial needs a correction");
  for (std::size_t s = 0; s < polynomials.size(); ++s)
    polynomials[s].derivatives[0] += corrections[s];
  return polynomials;
}

std::vector<LocalPolynomial> correctedPolynomials(CellData& data, const SpaceTable& space) {
  LocalFits fits(space.lattice.unit());
  return correctedPolynomials(data, space, fits);
}

PotentialField::PotentialField(CellData data, const SpaceTable& space)
    : PotentialField(data, correctedPolynomials(data, space)) {}

PotentialField::PotentialField(const CellData& data,
                               const std::vector<LocalPolynomial>& polynomials)
    : CellField("potential", data, Limit::bound),
      jets_(energyJets(data.tree, polynomials)),
      error_(data.tree, polynomials, jets_, data.suspect, data.has_fibers),
      failed_(failedSlots(data)) {
  PALPATE_ASSERT(jets_.size() == tree().slots().size(), "each corner of a cell needs derivatives");
}

void PotentialField::interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                                 ForceSample& sample) const noexcept {
  const EnergySample energy = evaluateEnergy(tree(), jets_, {leaf, local});
  sample.energy = energy.energy;
  sample.force = energy.force;
  sample.stiffness = energy.stiffness;
  sample.error_bound =
      error_.bound(leaf, local) +
      share_at_failed * trilinear(tree().corners(leaf), local, failed_) * sample.force.norm();
}

}  // namespace palpate
