#pragma once

#include "common/interpolation/branch_check.hpp"
#include "common/interpolation/cell_tree.hpp"
#include "common/interpolation/local_fit.hpp"

namespace palpate {

/// Derivative d^(a+b+c) E / dx^a dy^b dz^c, a, b, c <= 2, of the energy at a slot, times
/// spacing^(a+b+c), J, at [a + 3 b + 9 c].
using EnergyJet = std::array<double, 27>;

/// Energy and its derivatives; force = -gradient, stiffness = -Hessian.
struct EnergySample {
  double energy = 0;                                    ///< J
  Eigen::Vector3d force = Eigen::Vector3d::Zero();      ///< N
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();  ///< N/m, symmetric
};

/// What the nearest solved points say about the energy near every ghost: a least-squares fit. Zero
/// for other slots. Points that an inconsistent edge joins to a nearer source are left out. Spaces
/// on such a lattice may share the fits.
std::vector<LocalPolynomial> ghostPolynomials(const CellTree& tree, const SpaceTable& space,
                                              const std::vector<LatticeEdge>& inconsistent,
                                              LocalFits& fits);

/// The same of every slot, from `ghosts` (ghostPolynomials, which take nearly all of the time).
/// Solved slots have their own data exactly, the higher derivatives from a fit to the solved
/// corners of the leaves around, but those that an inconsistent edge joins to the slot or to a
/// nearer source. Zero for hanging slots.
std::vector<LocalPolynomial> slotPolynomials(const CellTree& tree, const SpaceTable& space,
                                             const std::vector<LatticeEdge>& inconsistent,
                                             std::vector<LocalPolynomial> ghosts, LocalFits& fits);

/// The jets of all slots from their polynomials (slotPolynomials), hanging ones from their coarser
/// leaf.
std::vector<EnergyJet> energyJets(const CellTree& tree,
                                  const std::vector<LocalPolynomial>& polynomials);

/// The same, those of hanging slots left to the caller.
std::vector<EnergyJet> slotJets(const CellTree& tree,
                                const std::vector<LocalPolynomial>& polynomials);

/// The jets at the corners of a leaf, in its units: corner c has jets[c].
using LeafJets = std::array<const EnergyJet*, 8>;

/// The tensor product quintic Hermite polynomial of the jets at the corners of a leaf, at a place
/// in it. Real time: does not allocate, lock, throw or log.
EnergySample evaluateEnergy(const CellTree& tree, const std::vector<EnergyJet>& jets,
                            const LeafPlace& place) noexcept;
/// The same of a leaf with edges of `edge` metres, 0..1 in which `local` is; jets are in units of
/// the spacing (metres).
EnergySample evaluateEnergy(const LeafJets& corners, double edge, double spacing,
                            const Eigen::Vector3d& local) noexcept;

/// Along one axis, what the derivative of order `wanted` at a place in a leaf is of the one of
/// order `known` at an end: factors [axis][wanted][end][known], all in units of the spacing.
using AxisFactors = std::array<std::array<std::array<std::array<double, 3>, 2>, 3>, 3>;
AxisFactors axisFactors(double edge, double spacing, const Eigen::Vector3d& local);

/// The 27 numbers of such a polynomial at a place in a leaf, from those at its corners: known(c,
/// n), of a type with sums and products with numbers. Axis after axis.
template <class Factor, class Value, class Known>
std::array<Value, 27> jetInLeaf(const AxisFactors& factors, const Value& zero, Known known) {
  std::array<Value, 108> by_x;  // [corner in y and z][orders in y and z][wanted in x]
  std::array<Value, 54> by_y;   // [corner in z][order in z][wanted in x, y]
  std::array<Value, 27> by_z;
  by_x.fill(zero);
  by_y.fill(zero);
  by_z.fill(zero);
  const auto add = [&](Value* to, std::size_t at, const Value& value, std::size_t axis,
                       std::size_t end, std::size_t order, std::size_t stride) {
    for (std::size_t wanted = 0; wanted < 3; ++wanted)
      to[at + stride * wanted] += static_cast<Factor>(factors[axis][wanted][end][order]) * value;
  };
  for (std::size_t c = 0; c < 8; ++c)
    for (std::size_t n = 0; n < 27; ++n)
      add(by_x.data(), 27 * (c >> 1) + 3 * (n / 3), known(c, n), 0, c & 1, n % 3, 1);
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t n = 0; n < 27; ++n)
      add(by_y.data(), 27 * (c >> 1) + 9 * (n / 9) + n % 3, by_x[27 * c + n], 1, c & 1, n / 3 % 3,
          3);
  for (std::size_t c = 0; c < 2; ++c)
    for (std::size_t n = 0; n < 27; ++n) add(by_z.data(), n % 9, by_y[27 * c + n], 2, c, n / 9, 9);
  return by_z;
}

/// What the value of such a polynomial is of the 27 numbers at each corner: its factors.
using LeafBasis = std::array<std::array<double, 27>, 8>;
LeafBasis valueBasis(double edge, double spacing, const Eigen::Vector3d& local) noexcept;
/// The same of its derivative along a direction, per metre.
LeafBasis slopeBasis(double edge, double spacing, const Eigen::Vector3d& local,
                     const Eigen::Vector3d& direction) noexcept;

}  // namespace palpate
