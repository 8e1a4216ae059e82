#pragma once

#include "common/scene/formulation.hpp"

/// Energy, residual and tangent of eight tetrahedra of one material at once (structure of arrays:
/// lane l of a pack belongs to tetrahedron l of the batch). The same source is compiled once per
/// CPU family (kernel_family.hpp).
///
/// What is discretised is the Lagrangian of docs/solver.md, per element, by the quadrature rule
/// of its displacement space,
///
///   L = integral of  W(F) - p c(det F) - p^2/(2 bulk)  dX  -  V alpha/(2 mu) <(p - <p>)^2>
///
/// or, without a pressure, of W(F) + U(det F). <.> is the mean over the element, V its volume; the
/// term with bulk is there when the material is compressible, the last one when the pressure is
/// stabilised.
namespace palpate {

inline constexpr int lanes = 8;

/// A value for each tetrahedron of a batch. Its alignment depends on the CPU family, so structs
/// that cross from one translation unit to another say theirs (alignas).
using Pack = double __attribute__((vector_size(lanes * sizeof(double))));

/// Nodes of the displacement and of the pressure of a tetrahedron, vertices first, then the middles
/// of the edges in the order of tetrahedron_edges (common/mesh/mesh.hpp).
constexpr int displacementNodes(DisplacementSpace space) {
  return space == DisplacementSpace::p1 ? 4 : 10;
}
constexpr int pressureNodes(PressureSpace space) {
  return space == PressureSpace::none ? 0 : space == PressureSpace::p2 ? 10 : 4;
}

/// Local unknowns: displacement component i of node a at 3 a + i, then the scaled pressures q; p =
/// scale q.
inline constexpr int most_local_unknowns = 40;
/// Entries of the upper triangle of the local tangent, row by row: (0,0) (0,1) ... (0,n-1) (1,1)
/// ...
constexpr int localEntries(int unknowns) { return unknowns * (unknowns + 1) / 2; }

struct alignas(64) BatchGeometry {
  /// Node numbers, as many as the displacement has. A batch that is not full repeats its last
  /// tetrahedron with volume 0.
  std::int32_t node[10][lanes];
  std::int32_t pressure[10][lanes];  ///< slots, as many as the pressure has
  /// gradient[b][I] = dx_b/dX_I of the barycentric coordinates of the first three vertices, 1/m;
  /// the fourth is minus their sum.
  Pack gradient[3][3];
  Pack volume;       ///< m^3
  Pack fiber[2][3];  ///< unit directions at rest, zero where there is none; for laws with fibres
};

/// A material and how it is discretised. Numbers that the law does not have stay zero.
struct ElementParameters {
  DisplacementSpace displacement = DisplacementSpace::p1;
  PressureSpace pressure = PressureSpace::none;  ///< none also where other materials have one
  Constraint constraint = Constraint::ln_det_F;
  double pressure_scale = 1;  ///< Pa per unit of q
  double stabilization = 0;   ///< alpha / mu, 1/Pa
  double bulk = 0;            ///< Pa; zero where det F = 1 exactly

  LawName law = LawName::mooney_rivlin;
  double lambda = 0, mu = 0;                     ///< Pa; lambda and mu of the law itself
  double c10 = 0, c01 = 0, c20 = 0, c30 = 0;     ///< Pa
  double c1 = 0, c2 = 0;                         ///< Pa, -
  double k1 = 0, k2 = 0, dispersion = 0;         ///< Pa, -, -
  double ogden_mu[3] = {}, ogden_alpha[3] = {};  ///< Pa, -
  int ogden_terms = 0;
};

struct alignas(64) BatchResult {
  Pack energy;  ///< L of each tetrahedron, J
  Pack det_F;   ///< the smallest of the quadrature points
  /// dL/d(unknown): N for displacements, scale * m^3 for pressures.
  Pack residual[most_local_unknowns];
};
struct alignas(64) BatchTangent {
  Pack entry[localEntries(most_local_unknowns)];  ///< second derivatives of L
};

/// The kernel of one CPU family. u: nNodes x 3 displacements, metres; q: scaled pressures by slot
/// (ignored without a pressure); no tangent is computed where there is no place for it (nullptr).
/// With ln det F or a volumetric energy, an element with det F <= 0 at a quadrature point gets NaN
/// or infinity. It keeps nothing and may run on any thread.
struct ElementKernels {
  const char* family;  ///< "avx512", "avx2" or "baseline"
  void (*evaluate)(const ElementParameters&, const BatchGeometry&, const double* u, const double* q,
                   BatchResult&, BatchTangent*);
};

}  // namespace palpate
