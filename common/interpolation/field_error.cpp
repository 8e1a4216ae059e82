#include "common/interpolation/field_error.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

// Factors of the bound, chosen with 18000 exact solutions on liver-493 (Mooney-Rivlin, three active
// nodes, balls of 60 and 100 mm, spacings from 10 to 33 mm). These solutions include the rim of the
// ball and the neighbourhood of jumps between branches. The bound holds at 99 % of these solutions.
// In the median it is 6 to 11 times the error (docs/internals/measurements.md).
constexpr double share_of_spread = 0.75;  ///< factor of the mean difference, without ghosts
/// Multiplied by the weight of the ghost corners and added to share_of_spread.
constexpr double share_at_ghosts = 2.5;
constexpr double at_suspect_edges = 3;  ///< factor of the bound in leaves with a suspect edge
/// Multiplied by the weight of rest and added to 1, as a factor for bodies with fibres. Chosen on
/// the muscles of gallery and yardstick, where the bound holds at 95 % of 40 and 99 % of 999
/// touches. Without: 85 and 86 %.
constexpr double share_at_rest_of_fibers = 16;

/// Evaluates the forces of local polynomials at the grid nodes of leaves. Caches the matrices of
/// LocalPolynomial::forcesAt(), because the same offsets, in units of the polynomial's scale, occur
/// again and again.
class NodeForces {
 public:
  Eigen::Vector3d at(const LocalPolynomial& polynomial, const Eigen::Vector3d& offset) {
    const Eigen::Vector3d x = offset / polynomial.scale;
    const std::array<std::int64_t, 3> key = {std::llround(x[0] * 1e6), std::llround(x[1] * 1e6),
                                             std::llround(x[2] * 1e6)};
    auto known = known_.find(key);
    if (known == known_.end()) known = known_.emplace(key, LocalPolynomial::forcesAt(x)).first;
    return known->second * polynomial.derivatives / polynomial.scale;
  }

 private:
  std::map<std::array<std::int64_t, 3>, LocalPolynomial::Forces> known_;
};

Eigen::Vector3d placeOf(std::size_t node) {
  const int n = static_cast<int>(node), i = n % 3, j = n / 3 % 3, k = n / 9;
  return 0.5 * Eigen::Vector3d(i, j, k);
}

bool hasSuspectEdge(const CellTree& tree, std::int32_t leaf,
                    const std::vector<LatticeEdge>& suspect) {
  return anyEdge(tree.corners(leaf), [&](std::int32_t a, std::int32_t b) {
    return contains(suspect, tree.slots()[at(a)].number, tree.slots()[at(b)].number);
  });
}

/// Returns the leaves from coarse to fine. In this order, the bound in a coarse leaf is known when
/// a finer leaf with a hanging corner needs it.
std::vector<std::int32_t> coarseFirst(const CellTree& tree) {
  std::vector<std::int32_t> order = countUp(tree.leaves().size());
  std::ranges::stable_sort(
      order, [&](std::int32_t a, std::int32_t b) { return tree.edge(a) > tree.edge(b); });
  return order;
}

/// Measures how far the polynomials at the corners of a leaf are from its interpolant.
class Disagreement {
 public:
  /// The arguments must outlive this object.
  Disagreement(const CellTree& tree, const std::vector<LocalPolynomial>& polynomials,
               const std::vector<EnergyJet>& jets, const std::vector<LatticeEdge>& suspect,
               bool has_fibers)
      : tree_(tree),
        polynomials_(polynomials),
        jets_(jets),
        suspect_(suspect),
        at_rest_(has_fibers ? share_at_rest_of_fibers : 0) {}

  /// Returns the error bound at a place in a leaf. inherited(leaf, local) must return the bound at
  /// a place in a coarser leaf; it is called for hanging corners.
  template <class Inherited>
  double boundAt(std::int32_t leaf, const Eigen::Vector3d& local, Inherited inherited) {
    const Eigen::Vector3d force = evaluateEnergy(tree_, jets_, {leaf, local}).force;
    const std::array<double, 8> weights = trilinearWeights(local);
    double spread = 0, sum = 0, ghosts = 0, rest = 0, hanging = 0, of_coarser = 0;
    int known = 0;
    for (std::size_t c = 0; c < 8; ++c) {
      const auto s = at(tree_.corners(leaf)[c]);
      const CellSlot& slot = tree_.slots()[s];
      if (slot.kind == SlotKind::hanging) {
        hanging += weights[c];
        if (weights[c] > 0) of_coarser += weights[c] * inherited(slot.place.leaf, slot.place.local);
        continue;
      }
      const Eigen::Vector3d corner(c & 1, c >> 1 & 1, c >> 2);
      const double difference =
          (forces_.at(polynomials_[s], (local - corner) * tree_.edge(leaf)) - force).norm();
      spread += weights[c] * difference;
      sum += difference;
      ++known;
      if (slot.kind == SlotKind::ghost) ghosts += weights[c];
      if (slot.number == 0) rest = weights[c];
    }
    // Hanging corners have no polynomial; use the mean difference of the other corners for them.
    if (known > 0) spread += hanging * sum / known;
    const double factor =
        (hasSuspectEdge(tree_, leaf, suspect_) ? at_suspect_edges : 1) * (1 + at_rest_ * rest);
    return factor * (share_of_spread + share_at_ghosts * ghosts) * spread + of_coarser;
  }

 private:
  const CellTree& tree_;
  const std::vector<LocalPolynomial>& polynomials_;
  const std::vector<EnergyJet>& jets_;
  const std::vector<LatticeEdge>& suspect_;
  const double at_rest_;
  NodeForces forces_;
};

}  // namespace

FieldError::FieldError(const CellTree& tree, const std::vector<LocalPolynomial>& polynomials,
                       const std::vector<EnergyJet>& jets, const std::vector<LatticeEdge>& suspect,
                       bool has_fibers)
    : nodes_(tree.leaves().size()) {
  PALPATE_ASSERT(polynomials.size() == tree.slots().size() && jets.size() == tree.slots().size(),
                 "polynomials and energies must be of the same cells");
  Disagreement disagreement(tree, polynomials, jets, suspect, has_fibers);
  for (const std::int32_t leaf : coarseFirst(tree))
    for (std::size_t node = 0; node < 27; ++node)
      nodes_[at(leaf)][node] = static_cast<float>(disagreement.boundAt(
          leaf, placeOf(node), [this](std::int32_t coarser, const Eigen::Vector3d& local) {
            return bound(coarser, local);
          }));
}

double FieldError::bound(std::int32_t leaf, const Eigen::Vector3d& local) const noexcept {
  const Nodes& nodes = nodes_[at(leaf)];
  std::size_t lowest = 0, stride = 1;
  Eigen::Vector3d within;
  for (Eigen::Index axis = 0; axis < 3; ++axis, stride *= 3) {
    const bool upper = local[axis] >= 0.5;
    lowest += upper ? stride : 0;
    within[axis] = 2 * local[axis] - (upper ? 1 : 0);
  }
  const std::array<double, 8> weights = trilinearWeights(within);
  double sum = 0;
  for (std::size_t c = 0; c < 8; ++c)
    sum +=
        weights[c] * static_cast<double>(nodes[lowest + (c & 1) + 3 * (c >> 1 & 1) + 9 * (c >> 2)]);
  return sum;
}

}  // namespace palpate
