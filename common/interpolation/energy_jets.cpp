#include "common/interpolation/energy_jets.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

// A ghost is extrapolated from solved points that are at most this many times as far away as the
// nearest one, and from at most Kind::most_extrapolated_from of them. A smaller factor reduces the
// accuracy at the rim of the ball; a larger one does not improve it.
constexpr double ghost_reach = 2.2;

/// Chooses the sources of each fit and fits the polynomials.
class Fitter {
 public:
  Fitter(const CellTree& tree, const SpaceTable& space,
         const std::vector<LatticeEdge>& inconsistent, LocalFits& fits)
      : tree_(tree),
        space_(space),
        interpolated_(interpolatedPoints(space)),
        fits_(fits),
        inconsistent_(inconsistent) {
    PALPATE_ASSERT(std::ranges::is_sorted(inconsistent), "inconsistent edges must be sorted");
    PALPATE_ASSERT(inconsistent.empty() || inconsistent.back().a < space.lattice.size(),
                   "inconsistent edges must join points of this space");
    PALPATE_ASSERT(tree.spacing() == space.lattice.spacing() && tree.unit() == space.lattice.unit(),
                   "the tree must have the lattice of the space");
    const std::int32_t divisions = space.lattice.divisions();
    around_.resize(tree.slots().size());
    edge_.assign(tree.slots().size(), 0);
    for (std::size_t leaf = 0; leaf < tree.leaves().size(); ++leaf)
      for (const std::int32_t slot : tree.corners(static_cast<std::int32_t>(leaf))) {
        around_[at(slot)].push_back(static_cast<std::int32_t>(leaf));
        std::int32_t& edge = edge_[at(slot)];
        edge = std::max(edge, divisions >> tree.leaves()[leaf].level);
      }
    for (std::int32_t n = 0; n < space.lattice.size(); ++n)
      if (interpolated_[at(n)]) solved_.push_back(n);
    findKnown();
  }

  /// Fits the polynomial of a solved slot. It reproduces the slot's own data exactly; its higher
  /// derivatives are fitted to the solved points around the slot.
  LocalPolynomial complete(std::size_t slot) {
    const std::int32_t number = tree_.slots()[slot].number;
    return fits_.complete(space_.points[number].equilibrium, neighbours(slot, number), edge_[slot],
                          known_[at(number)]);
  }

  /// Fits the polynomial of a ghost to the nearest solved points.
  LocalPolynomial extrapolate(std::size_t slot) {
    std::vector<Candidate> candidates = mapped(
        solved_, [&](std::int32_t number) { return candidate(tree_.slots()[slot].point, number); });
    const Candidate nearest = *std::ranges::min_element(candidates);
    std::erase_if(candidates, [&](const Candidate& c) {
      return static_cast<double>(c.distance) >
             ghost_reach * ghost_reach * static_cast<double>(nearest.distance);
    });
    const auto sources = choose(std::move(candidates), -1, fits_.kind().most_extrapolated_from);
    const auto edge =
        static_cast<std::int32_t>(std::ceil(std::sqrt(static_cast<double>(nearest.distance))));
    // A polynomial of high degree overshoots far from its sources. Reduce the degree until its
    // force is plausible.
    for (int degree = fits_.degreeFor(sources.size());; --degree) {
      LocalPolynomial polynomial = fits_.extrapolate(sources, edge, degree);
      if (degree == 2 || isModest(polynomial.at(Eigen::Vector3d::Zero()), nearest, sources))
        return polynomial;
    }
  }

 private:
  bool joined(std::int32_t a, std::int32_t b) const { return contains(inconsistent_, a, b); }

  struct Candidate {
    std::int64_t distance;
    LatticePoint offset;
    std::int32_t number;
    auto operator<=>(const Candidate&) const = default;
  };

  /// Returns the nearest candidates, at most `most`. A candidate is left out if an inconsistent
  /// edge joins it to `own` (a lattice number, or -1) or to a nearer candidate that was chosen.
  std::vector<FitSource> choose(std::vector<Candidate> candidates, std::int32_t own,
                                std::size_t most) const {
    std::ranges::sort(candidates);
    std::vector<std::int32_t> taken;
    if (own >= 0) taken.push_back(own);
    std::vector<FitSource> sources;
    for (const Candidate& c : candidates) {
      if (sources.size() == most) break;
      if (std::ranges::any_of(taken, [&](std::int32_t t) { return joined(t, c.number); })) continue;
      taken.push_back(c.number);
      sources.push_back({c.offset, &space_.points[c.number].equilibrium, known_[at(c.number)]});
    }
    return sources;
  }

  /// Determines the highest order of the data that is used, for each point at a slot
  /// (LocalFits::judge).
  void findKnown() {
    known_.assign(space_.points.size(), fits_.kind().known);
    if (!fits_.kind().highest_known_are_judged) return;
    for (std::size_t slot = 0; slot < tree_.slots().size(); ++slot) {
      const auto number = space_.lattice.indexOf(tree_.slots()[slot].point);
      if (number && interpolated_[at(*number)])
        known_[at(*number)] =
            fits_.judge(space_.points[at(*number)].equilibrium, neighbours(slot, *number));
    }
  }

  /// Returns the sources for the solved point `own` at a slot: the solved corners of the leaves
  /// around it, including hanging corners that are solved points.
  std::vector<FitSource> neighbours(std::size_t slot, std::int32_t own) const {
    const CellSlot& center = tree_.slots()[slot];
    std::set<std::int32_t> numbers;
    for (const std::int32_t leaf : around_[slot])
      for (const std::int32_t corner : tree_.corners(leaf)) {
        const auto number = space_.lattice.indexOf(tree_.slots()[at(corner)].point);
        if (number && *number != own && interpolated_[at(*number)]) numbers.insert(*number);
      }
    std::vector<Candidate> candidates;
    for (const std::int32_t number : numbers) candidates.push_back(candidate(center.point, number));
    return choose(std::move(candidates), own, fits_.kind().most_completed_from);
  }

  Candidate candidate(const LatticePoint& center, std::int32_t number) const {
    LatticePoint offset = space_.lattice.point(number);
    for (std::size_t axis = 0; axis < 3; ++axis) offset[axis] -= center[axis];
    return {squaredNorm(offset), offset, number};
  }

  /// Returns whether the force at a ghost is plausible. Its difference from the force at the
  /// nearest source must be at most twice the usual change. The usual change is the one that the
  /// stiffness of the nearest source predicts, or the largest change from the nearest source to
  /// another one if that is larger.
  bool isModest(const Equilibrium& ghost, const Candidate& nearest,
                const std::vector<FitSource>& sources) const {
    const Equilibrium& base = space_.points[nearest.number].equilibrium;
    const Eigen::Vector3d step =
        -tree_.unit() * Eigen::Vector3d(nearest.offset[0], nearest.offset[1], nearest.offset[2]);
    double usual = (base.stiffness * step).norm();
    for (const FitSource& source : sources)
      usual = std::max(usual, (source.data->force - base.force).norm());
    return (ghost.force - base.force).norm() <= 2 * usual;
  }

  const CellTree& tree_;
  const SpaceTable& space_;
  const std::vector<bool> interpolated_;
  LocalFits& fits_;
  const std::vector<LatticeEdge>& inconsistent_;
  std::vector<std::vector<std::int32_t>> around_;  ///< per slot, the adjacent leaves
  /// Per slot, the largest edge of the adjacent leaves, in lattice units.
  std::vector<std::int32_t> edge_;
  std::vector<std::int32_t> solved_;
  std::vector<KnownOrders> known_;  ///< per point
};

EnergyJet jetOf(const LocalPolynomial& polynomial, double spacing) {
  EnergyJet jet{};
  for (std::size_t t = 0; t < LocalPolynomial::terms; ++t) {
    const Orders& o = LocalPolynomial::orders(t);
    if (o[0] > 2 || o[1] > 2 || o[2] > 2) continue;
    jet[at(o[0] + 3 * o[1] + 9 * o[2])] = polynomial.derivatives[static_cast<Eigen::Index>(t)] *
                                          std::pow(spacing / polynomial.scale, o[0] + o[1] + o[2]);
  }
  return jet;
}

/// Coefficients of the data at both ends of an interval, for one derivative at a place: [end
/// 0..1][order of the datum 0..2].
using AxisBasis = std::array<std::array<double, 3>, 2>;
/// Quintic Hermite basis along an axis, on the interval 0..1: the coefficients for the value, the
/// first and the second derivative.
using Basis = std::array<AxisBasis, 3>;

/// Returns the basis at t. The functions f, g and k belong to the lower end: there f has value 1, g
/// slope 1 and k curvature 1, and everything else is zero. The functions of the upper end are their
/// mirror images, with the sign of odd orders reversed.
Basis quinticHermite(double t) {
  const double s = 1 - t;
  Basis basis;
  const auto set = [&basis](std::size_t derivative, double f0, double f1, double g0, double g1,
                            double k0, double k1) {
    basis[derivative] = {{{f0, g0, k0}, {f1, g1, k1}}};
  };
  const auto f = [](double x) { return 1 + x * x * x * (-10 + x * (15 - 6 * x)); };
  const auto g = [](double x) { return x + x * x * x * (-6 + x * (8 - 3 * x)); };
  const auto k = [](double x) { return 0.5 * x * x * (1 + x * (-3 + x * (3 - x))); };
  const auto df = [](double x) { return x * x * (-30 + x * (60 - 30 * x)); };
  const auto dg = [](double x) { return 1 + x * x * (-18 + x * (32 - 15 * x)); };
  const auto dk = [](double x) { return x * (1 + x * (-4.5 + x * (6 - 2.5 * x))); };
  const auto ddf = [](double x) { return x * (-60 + x * (180 - 120 * x)); };
  const auto ddg = [](double x) { return x * (-36 + x * (96 - 60 * x)); };
  const auto ddk = [](double x) { return 1 + x * (-9 + x * (18 - 10 * x)); };
  set(0, f(t), f(s), g(t), -g(s), k(t), k(s));
  set(1, df(t), -df(s), dg(t), dg(s), dk(t), -dk(s));
  set(2, ddf(t), ddf(s), ddg(t), -ddg(s), ddk(t), ddk(s));
  return basis;
}

/// Returns the basis along an axis of a leaf with edges of `edge`, for data that are scaled with
/// the spacing.
Basis basisIn(double edge, double spacing, double local) {
  Basis basis = quinticHermite(local);
  if (edge == spacing) return basis;
  const double scale = edge / spacing;
  for (AxisBasis& derivative : basis)
    for (auto& end : derivative) {
      end[1] *= scale;
      end[2] *= scale * scale;
    }
  return basis;
}

std::array<Basis, 3> basesIn(double edge, double spacing, const Eigen::Vector3d& local) {
  return {basisIn(edge, spacing, local.x()), basisIn(edge, spacing, local.y()),
          basisIn(edge, spacing, local.z())};
}

void addProduct(const AxisBasis& of_x, const AxisBasis& of_y, const AxisBasis& of_z, double factor,
                LeafBasis& basis) {
  for (std::size_t c = 0; c < 8; ++c) {
    const auto &x = of_x[c & 1], &y = of_y[c >> 1 & 1], &z = of_z[c >> 2];
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t i = 0; i < 3; ++i)
          basis[c][i + 3 * j + 9 * k] += factor * x[i] * y[j] * z[k];
  }
}

}  // namespace

std::vector<LocalPolynomial> slotPolynomials(const CellTree& tree, const SpaceTable& space,
                                             const std::vector<LatticeEdge>& inconsistent,
                                             std::vector<LocalPolynomial> ghosts, LocalFits& fits) {
  PALPATE_ASSERT(ghosts.size() == tree.slots().size(), "each corner of a cell needs a polynomial");
  Fitter fitter(tree, space, inconsistent, fits);
  for (std::size_t slot = 0; slot < ghosts.size(); ++slot)
    if (tree.slots()[slot].kind == SlotKind::solved) ghosts[slot] = fitter.complete(slot);
  return ghosts;
}

std::vector<LocalPolynomial> ghostPolynomials(const CellTree& tree, const SpaceTable& space,
                                              const std::vector<LatticeEdge>& inconsistent,
                                              LocalFits& fits) {
  Fitter fitter(tree, space, inconsistent, fits);
  std::vector<LocalPolynomial> polynomials(tree.slots().size());
  for (std::size_t slot = 0; slot < polynomials.size(); ++slot)
    if (tree.slots()[slot].kind == SlotKind::ghost) polynomials[slot] = fitter.extrapolate(slot);
  return polynomials;
}

std::vector<EnergyJet> slotJets(const CellTree& tree,
                                const std::vector<LocalPolynomial>& polynomials) {
  return mapped(polynomials, [&](const LocalPolynomial& polynomial) {
    return jetOf(polynomial, tree.spacing());
  });
}

std::vector<EnergyJet> energyJets(const CellTree& tree,
                                  const std::vector<LocalPolynomial>& polynomials) {
  PALPATE_ASSERT(polynomials.size() == tree.slots().size(), "each cell corner needs a polynomial");
  std::vector<EnergyJet> jets = slotJets(tree, polynomials);
  fillHanging(tree, jets, [&](std::int32_t leaf, const Eigen::Vector3d& local) {
    return jetInLeaf<double>(
        axisFactors(tree.edge(leaf), tree.spacing(), local), 0.0,
        [&](std::size_t c, std::size_t n) { return jets[at(tree.corners(leaf)[c])][n]; });
  });
  return jets;
}

EnergySample evaluateEnergy(const CellTree& tree, const std::vector<EnergyJet>& jets,
                            const LeafPlace& place) noexcept {
  const LeafCorners& slots = tree.corners(place.leaf);
  LeafJets corners;
  for (std::size_t c = 0; c < 8; ++c) corners[c] = &jets[at(slots[c])];
  return evaluateEnergy(corners, tree.edge(place.leaf), tree.spacing(), place.local);
}

AxisFactors axisFactors(double edge, double spacing, const Eigen::Vector3d& local) {
  const double scale = edge / spacing;
  const std::array<double, 5> powers = {1 / (scale * scale), 1 / scale, 1, scale, scale * scale};
  AxisFactors factors;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    factors[axis] = quinticHermite(local[static_cast<Eigen::Index>(axis)]);
    for (std::size_t wanted = 0; wanted < 3; ++wanted)
      for (auto& end : factors[axis][wanted])
        for (std::size_t order = 0; order < 3; ++order) end[order] *= powers[2 + order - wanted];
  }
  return factors;
}

LeafBasis valueBasis(double edge, double spacing, const Eigen::Vector3d& local) noexcept {
  const auto [x, y, z] = basesIn(edge, spacing, local);
  LeafBasis basis{};
  addProduct(x[0], y[0], z[0], 1, basis);
  return basis;
}

LeafBasis slopeBasis(double edge, double spacing, const Eigen::Vector3d& local,
                     const Eigen::Vector3d& direction) noexcept {
  const auto [x, y, z] = basesIn(edge, spacing, local);
  LeafBasis basis{};
  addProduct(x[1], y[0], z[0], direction.x() / edge, basis);
  addProduct(x[0], y[1], z[0], direction.y() / edge, basis);
  addProduct(x[0], y[0], z[1], direction.z() / edge, basis);
  return basis;
}

/// Sums over z first, then y, then x, so that the longest sums run over contiguous memory.
EnergySample evaluateEnergy(const LeafJets& corners, double edge, double spacing,
                            const Eigen::Vector3d& local) noexcept {
  using Plane = Eigen::Array<double, 9, 1>;  // orders a + 3 b at a corner
  using Line = Eigen::Array3d;               // orders a
  const auto [x, y, z] = basesIn(edge, spacing, local);
  // Derivatives of the interpolant, of order f along z, e along y and d along x at [f][e][d]; only
  // d + e + f <= 2.
  double d[3][3][3] = {};
  for (std::size_t x_end = 0; x_end < 2; ++x_end) {
    Line lines[3][3];  // [derivative f along z][e along y]
    for (auto& row : lines)
      for (Line& line : row) line.setZero();
    for (std::size_t y_end = 0; y_end < 2; ++y_end) {
      const double* low = corners[x_end + 2 * y_end]->data();
      const double* high = corners[x_end + 2 * y_end + 4]->data();
      const Eigen::Map<const Plane> l0(low), l1(low + 9), l2(low + 18), h0(high), h1(high + 9),
          h2(high + 18);
      for (std::size_t f = 0; f < 3; ++f) {
        const auto& b = z[f];
        const Plane plane =
            b[0][0] * l0 + b[0][1] * l1 + b[0][2] * l2 + b[1][0] * h0 + b[1][1] * h1 + b[1][2] * h2;
        for (std::size_t e = 0; e + f < 3; ++e)
          lines[f][e] += y[e][y_end][0] * plane.segment<3>(0) +
                         y[e][y_end][1] * plane.segment<3>(3) +
                         y[e][y_end][2] * plane.segment<3>(6);
      }
    }
    for (std::size_t f = 0; f < 3; ++f)
      for (std::size_t e = 0; e + f < 3; ++e)
        for (std::size_t order = 0; order + e + f < 3; ++order)
          d[f][e][order] += x[order][x_end][0] * lines[f][e][0] +
                            x[order][x_end][1] * lines[f][e][1] +
                            x[order][x_end][2] * lines[f][e][2];
  }
  EnergySample sample;
  sample.energy = d[0][0][0];
  sample.force = -Eigen::Vector3d(d[0][0][1], d[0][1][0], d[1][0][0]) / edge;
  sample.stiffness << d[0][0][2], d[0][1][1], d[1][0][1],  //
      d[0][1][1], d[0][2][0], d[1][1][0],                  //
      d[1][0][1], d[1][1][0], d[2][0][0];
  sample.stiffness /= -edge * edge;
  return sample;
}

}  // namespace palpate
