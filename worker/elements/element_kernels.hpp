#pragma once

#include "common/scene/formulation.hpp"

/// Energy, residual and tangent of eight tetrahedra of one material at once (structure of arrays:
/// lane l of a pack belongs to tetrahedron l of the batch). The same source is compiled once per
/// CPU family (kernel_family.hpp).
///
/// Discretises the Lagrangian of docs/solver.md per element, with the quadrature rule of the
/// displacement space,
///
///   L = integral of  W(F) - p c(det F) - p^2/(2 bulk)  dX  -  V alpha/(2 mu) <(p - <p>)^2>
///
/// or, without a pressure, the integral of W(F) + U(det F). <.> is the mean over the element and V
/// its volume. The bulk term applies to compressible materials, the last term to stabilised
/// pressures.
namespace palpate {

inline constexpr int lanes = 8;

/// One value per tetrahedron of a batch. The alignment of this type depends on the CPU family, so
/// structs that pass between translation units set their own alignment (alignas).
using Pack = double __attribute__((vector_size(lanes * sizeof(double))));

/// Return the number of displacement or pressure nodes of a tetrahedron. Vertices come first, then
/// the mid-edge nodes in the order of tetrahedron_edges (common/mesh/mesh.hpp).
constexpr int displacementNodes(DisplacementSpace space) {
  return space == DisplacementSpace::p1 ? 4 : 10;
}
constexpr int pressureNodes(PressureSpace space) {
  return space == PressureSpace::none ? 0 : space == PressureSpace::p2 ? 10 : 4;
}

/// Largest number of unknowns of one element. Unknown 3 a + i is component i of the displacement of
/// node a. The scaled pressures q follow; the pressure is p = pressure_scale * q.
inline constexpr int most_local_unknowns = 40;
/// Returns the number of entries in the upper triangle of an element's tangent. They are stored row
/// by row: (0,0) ... (0,n-1) (1,1) ...
constexpr int localEntries(int unknowns) { return unknowns * (unknowns + 1) / 2; }

struct alignas(64) BatchGeometry {
  /// Node numbers, one per displacement node. A partial batch repeats its last tetrahedron with
  /// volume 0.
  std::int32_t node[10][lanes];
  std::int32_t pressure[10][lanes];  ///< slot number per pressure node (PressureSlots)
  /// gradient[b][I] = dx_b/dX_I of the barycentric coordinates of the first three vertices, 1/m.
  /// The gradient of the fourth coordinate is minus their sum.
  Pack gradient[3][3];
  Pack volume;       ///< m^3
  Pack fiber[2][3];  ///< unit directions at rest, zero if absent; for laws with fibres
};

/// A material and its discretisation. Parameters that the law does not have stay zero.
struct ElementParameters {
  DisplacementSpace displacement = DisplacementSpace::p1;
  PressureSpace pressure = PressureSpace::none;  ///< of this material; others may differ
  Constraint constraint = Constraint::ln_det_F;
  double pressure_scale = 1;  ///< Pa per unit of q
  double stabilization = 0;   ///< alpha / mu, 1/Pa
  /// Pa; zero for an exactly incompressible material. With a pressure, the laws linear and
  /// st-venant-kirchhoff have lambda here.
  double bulk = 0;

  LawName law = LawName::mooney_rivlin;
  double lambda = 0, mu = 0;                     ///< Pa; as in the formula of the law
  double c10 = 0, c01 = 0, c20 = 0, c30 = 0;     ///< Pa
  double c1 = 0, c2 = 0;                         ///< Pa; c2 has no unit
  double k1 = 0, k2 = 0, dispersion = 0;         ///< Pa; k2 and dispersion have no unit
  double ogden_mu[3] = {}, ogden_alpha[3] = {};  ///< Pa; alpha has no unit
  int ogden_terms = 0;
};

struct alignas(64) BatchResult {
  Pack energy;  ///< L of each tetrahedron, J
  Pack det_F;   ///< smallest value at the quadrature points of each tetrahedron
  /// dL/d(unknown): N for displacements, pressure_scale * m^3 for pressures.
  Pack residual[most_local_unknowns];
};
struct alignas(64) BatchTangent {
  Pack entry[localEntries(most_local_unknowns)];  ///< second derivatives of L
};

/// The element kernel, compiled for one CPU family.
///
/// `u` has nNodes x 3 displacements, metres. `q` has the scaled pressures by slot, and is ignored
/// if the material has no pressure. If the tangent is nullptr, it is not computed. With ln det F or
/// a volumetric energy, an element with det F <= 0 at a quadrature point gets results that are NaN
/// or infinite. Stateless; may run on any thread.
struct ElementKernels {
  const char* family;  ///< "avx512", "avx2" or "baseline"
  void (*evaluate)(const ElementParameters&, const BatchGeometry&, const double* u, const double* q,
                   BatchResult&, BatchTangent*);
};

}  // namespace palpate
