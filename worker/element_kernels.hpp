#pragma once

#include <cstdint>

#include "common/formulation.hpp"

/// Energy, residual and tangent of eight linear tetrahedra at once (structure of arrays: lane l of a pack
/// belongs to tetrahedron l of the batch). The same source is compiled once per CPU family
/// (kernel_family.hpp).
///
/// What is discretised is the Lagrangian of the paper's Sec. 3, per element with constant F and volume V:
///
///   L = V W(F) - V p c(det F) - V alpha/(2 mu) <(p - <p>)^2>
///
/// p linear from its four nodal values, <.> the mean over the element, c(J) = ln J or J - 1 the constraint,
/// and the last term the polynomial pressure projection of Dohrmann and Bochev (alpha = 1 when stabilised,
/// else 0).
namespace palpate {

inline constexpr int lanes = 8;

/// A value for each tetrahedron of a batch. Its alignment depends on the CPU family, so structs that cross
/// from one translation unit to another say theirs (alignas).
using Pack = double __attribute__((vector_size(lanes * sizeof(double))));

/// Local unknowns of a tetrahedron: node a has (u_x, u_y, u_z, q) at 4a .. 4a+3. q is the scaled pressure, p
/// = scale q.
inline constexpr int local_unknowns = 16;
/// Entries of the upper triangle of the local tangent, row by row: (0,0) (0,1) ... (0,15) (1,1) ...
inline constexpr int local_entries = local_unknowns * (local_unknowns + 1) / 2;

struct alignas(64) BatchGeometry {
  std::int32_t
      node[4][lanes];   ///< node numbers; a batch that is not full repeats its last tetrahedron with volume 0
  Pack gradient[3][3];  ///< gradient[a][I] = dN_a/dX_I of the first three nodes, 1/m; the fourth is minus
                        ///< their sum
  Pack volume;          ///< m^3
};

/// The numbers of a law and of the mixed formulation.
struct ElementParameters {
  LawName law = LawName::mooney_rivlin;
  double lambda = 0, mu = 0;  ///< Pa; St. Venant-Kirchhoff laws and linear
  double c10 = 0, c01 = 0;    ///< Pa; Mooney-Rivlin
  PressureSpace pressure = PressureSpace::none;
  Constraint constraint = Constraint::ln_det_F;
  double pressure_scale = 1;  ///< Pa per unit of q
  double stabilization = 0;   ///< alpha / mu, 1/Pa
};

struct alignas(64) BatchResult {
  Pack energy;  ///< L of each tetrahedron, J
  Pack det_F;
  Pack residual[local_unknowns];  ///< dL/d(unknown): N for displacements, scale * m^3 for pressures
};
struct alignas(64) BatchTangent {
  Pack entry[local_entries];  ///< second derivatives of L
};

/// The two kernels of one CPU family. u: nNodes x 3 displacements, metres; q: nNodes scaled pressures
/// (ignored without a pressure space). With ln det F, an element with det F <= 0 gets NaN.
struct ElementKernels {
  const char* family;
  void (*residual)(const ElementParameters&, const BatchGeometry&, const double* u, const double* q,
                   BatchResult&);
  void (*tangent)(const ElementParameters&, const BatchGeometry&, const double* u, const double* q,
                  BatchResult&, BatchTangent&);
};

}  // namespace palpate
