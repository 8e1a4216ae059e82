#pragma once

#include "common/interpolation/branch_check.hpp"
#include "common/interpolation/cell_tree.hpp"
#include "common/interpolation/local_fit.hpp"

namespace palpate {

/// Derivatives of the energy at a slot. Entry [a + 3 b + 9 c], with a, b, c <= 2, is d^(a+b+c) E /
/// dx^a dy^b dz^c times spacing^(a+b+c), in J.
using EnergyJet = std::array<double, 27>;

/// The energy at a displacement, the force (minus its gradient) and the stiffness (minus its
/// Hessian).
struct EnergySample {
  double energy = 0;                                    ///< J
  Eigen::Vector3d force = Eigen::Vector3d::Zero();      ///< N
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();  ///< N/m, symmetric
};

/// Fits, around every ghost (SlotKind), a polynomial of the energy by least squares. The fit uses
/// the data of the nearest solved points, called the sources of the ghost. Returns one polynomial
/// per slot, zero for slots that are not ghosts. A point is not a source if an inconsistent edge
/// joins it to a nearer source. Spaces with equal lattices may share `fits`.
std::vector<LocalPolynomial> ghostPolynomials(const CellTree& tree, const SpaceTable& space,
                                              const std::vector<LatticeEdge>& inconsistent,
                                              LocalFits& fits);

/// Returns the polynomials of all slots. `ghosts` is the result of ghostPolynomials(), which takes
/// nearly all of the time. The polynomial of a solved slot reproduces the slot's own data exactly.
/// Its higher derivatives are fitted to the solved corners of the adjacent leaves. Corners are left
/// out if an inconsistent edge joins them to the slot or to a nearer corner that is used. The
/// polynomials of hanging slots are zero.
std::vector<LocalPolynomial> slotPolynomials(const CellTree& tree, const SpaceTable& space,
                                             const std::vector<LatticeEdge>& inconsistent,
                                             std::vector<LocalPolynomial> ghosts, LocalFits& fits);

/// Returns the jets of all slots. The jet of a hanging slot is interpolated in the slot's coarser
/// leaf. All other jets are taken from the slots' polynomials (slotPolynomials).
std::vector<EnergyJet> energyJets(const CellTree& tree,
                                  const std::vector<LocalPolynomial>& polynomials);

/// Returns the jets of all slots from their polynomials. The caller must fill in the jets of
/// hanging slots.
std::vector<EnergyJet> slotJets(const CellTree& tree,
                                const std::vector<LocalPolynomial>& polynomials);

/// The jets at the corners of a leaf; element c is the jet at corner c.
using LeafJets = std::array<const EnergyJet*, 8>;

/// Evaluates the tensor-product quintic Hermite polynomial of the jets at the corners of a leaf.
/// Real time: does not allocate, lock, throw or log.
EnergySample evaluateEnergy(const CellTree& tree, const std::vector<EnergyJet>& jets,
                            const LeafPlace& place) noexcept;
/// Evaluates the polynomial in a leaf with edges of `edge` metres, at `local` (0..1 in the leaf).
/// The jets are scaled with `spacing`, metres.
EnergySample evaluateEnergy(const LeafJets& corners, double edge, double spacing,
                            const Eigen::Vector3d& local) noexcept;

/// 1-D Hermite basis along each axis, at a place in a leaf, with indices
/// [axis][wanted][end][known]. A factor is the contribution of the derivative of order `known` at
/// an end of the leaf to the derivative of order `wanted` at the place. Both derivatives are in
/// units of the spacing.
using AxisFactors = std::array<std::array<std::array<std::array<double, 3>, 2>, 3>, 3>;
AxisFactors axisFactors(double edge, double spacing, const Eigen::Vector3d& local);

/// Interpolates the jet at a place in a leaf, one axis after the other. known(c, n) returns entry n
/// of the jet at corner c. `factors` is axisFactors() at the place, and `zero` is the zero of
/// Value, a type whose values can be added and multiplied by a Factor.
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

/// Coefficients with which the 27 numbers of each corner's jet contribute to the interpolated
/// energy, or to a derivative of it: [corner][number].
using LeafBasis = std::array<std::array<double, 27>, 8>;
LeafBasis valueBasis(double edge, double spacing, const Eigen::Vector3d& local) noexcept;
/// Returns the coefficients of the derivative along `direction`, per metre.
LeafBasis slopeBasis(double edge, double spacing, const Eigen::Vector3d& local,
                     const Eigen::Vector3d& direction) noexcept;

}  // namespace palpate
