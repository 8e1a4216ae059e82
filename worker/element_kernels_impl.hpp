// Included once per CPU family, with PALPATE_KERNEL_NAMESPACE set to a name of its own and the compiler flags
// of that family. Nothing here may be an inline function of another header: the linker would keep one
// family's copy for all.
#include <cmath>

#include "worker/element_kernels.hpp"
#include "worker/laws.hpp"

namespace palpate::PALPATE_KERNEL_NAMESPACE {
namespace {

#define PALPATE_INLINE inline __attribute__((always_inline))

PALPATE_INLINE Pack logarithm(Pack x) {
  Pack y;
  for (int l = 0; l < lanes; ++l) y[l] = std::log(x[l]);
  return y;
}

/// What the deformation of a batch amounts to.
struct Kinematics {
  Pack F[3][3];
  Strain<Pack> strain;
  Pack gradient[4][3];  ///< dN_a/dX
  Pack q[4], q_mean;
};

template <bool small_strain, bool mixed>
PALPATE_INLINE void deform(const BatchGeometry& geometry, const double* u, const double* q, Kinematics& k) {
  for (int I = 0; I < 3; ++I) {
    for (int a = 0; a < 3; ++a) k.gradient[a][I] = geometry.gradient[a][I];
    k.gradient[3][I] = -(k.gradient[0][I] + k.gradient[1][I] + k.gradient[2][I]);
  }
  Pack grad_u[3][3] = {};
  for (int i = 0; i < 3; ++i) {
    Pack nodal[4];
    for (int a = 0; a < 4; ++a)
      for (int l = 0; l < lanes; ++l) nodal[a][l] = u[3 * geometry.node[a][l] + i];
    for (int a = 0; a < 3; ++a) {
      const Pack difference = nodal[a] - nodal[3];
      for (int I = 0; I < 3; ++I) grad_u[i][I] += difference * k.gradient[a][I];
    }
  }
  for (int i = 0; i < 3; ++i)
    for (int I = 0; I < 3; ++I) k.F[i][I] = grad_u[i][I] + (i == I ? 1.0 : 0.0);
  const auto& F = k.F;
  k.strain.J = F[0][0] * (F[1][1] * F[2][2] - F[1][2] * F[2][1]) -
               F[0][1] * (F[1][0] * F[2][2] - F[1][2] * F[2][0]) +
               F[0][2] * (F[1][0] * F[2][1] - F[1][1] * F[2][0]);
  for (int v = 0; v < 6; ++v) {
    const int I = voigt_row[v], K = voigt_column[v];
    // From grad u, not from F^T F - I: no cancellation at small strain.
    Pack e = grad_u[I][K] + grad_u[K][I];
    if constexpr (!small_strain)
      for (int i = 0; i < 3; ++i) e += grad_u[i][I] * grad_u[i][K];
    k.strain.e[v] = v < 3 ? 0.5 * e : e;
  }
  if constexpr (mixed) {
    Pack C[6];
    for (int v = 0; v < 6; ++v) C[v] = v < 3 ? 2.0 * k.strain.e[v] + 1.0 : k.strain.e[v];
    const Pack inverse_det = 1.0 / (k.strain.J * k.strain.J);
    k.strain.C_inverse[0] = (C[1] * C[2] - C[4] * C[4]) * inverse_det;
    k.strain.C_inverse[1] = (C[0] * C[2] - C[5] * C[5]) * inverse_det;
    k.strain.C_inverse[2] = (C[0] * C[1] - C[3] * C[3]) * inverse_det;
    k.strain.C_inverse[3] = (C[5] * C[4] - C[3] * C[2]) * inverse_det;
    k.strain.C_inverse[4] = (C[3] * C[5] - C[0] * C[4]) * inverse_det;
    k.strain.C_inverse[5] = (C[3] * C[4] - C[5] * C[1]) * inverse_det;
    for (int a = 0; a < 4; ++a)
      for (int l = 0; l < lanes; ++l) k.q[a][l] = q[geometry.node[a][l]];
    k.q_mean = 0.25 * (k.q[0] + k.q[1] + k.q[2] + k.q[3]);
  }
}

/// The constraint c(J) with a = J c'(J) and b = J da/dJ.
struct ConstraintValues {
  Pack c, a, b;
};

PALPATE_INLINE ConstraintValues constrain(Constraint constraint, Pack J) {
  if (constraint == Constraint::ln_det_F) return {logarithm(J), Pack{} + 1.0, Pack{}};
  return {J - 1.0, J, J};
}

/// Element matrix of the pressure projection, V alpha/mu [ (1 + delta_ab)/20 - 1/16 ], without V alpha/mu.
constexpr double projection(int a, int b) {
  return (a == b ? 2.0 : 1.0) / 20 - 1.0 / 16;
}

template <class Law, bool mixed>
PALPATE_INLINE void computeResidual(const Law& law, const ElementParameters& parameters,
                                    const BatchGeometry& geometry, const Kinematics& k, BatchResult& result,
                                    ConstraintValues& constraint, Pack (&S)[6]) {
  const Pack V = geometry.volume;
  Pack W;
  law.evaluate(k.strain, W, S);
  Pack L = W;
  const double scale = parameters.pressure_scale;
  for (Pack& r : result.residual) r = Pack{};
  if constexpr (mixed) {
    constraint = constrain(parameters.constraint, k.strain.J);
    const Pack p = scale * k.q_mean;
    L -= p * constraint.c;
    for (int v = 0; v < 6; ++v) S[v] -= p * constraint.a * k.strain.C_inverse[v];
    const double stabilization = parameters.stabilization * scale * scale;
    for (int a = 0; a < 4; ++a) {
      Pack projected = Pack{};
      for (int b = 0; b < 4; ++b) projected += projection(a, b) * k.q[b];
      L -= 0.5 * stabilization * projected * k.q[a];
      result.residual[4 * a + 3] = -V * (0.25 * scale * constraint.c + stabilization * projected);
    }
  }
  result.energy = V * L;
  result.det_F = k.strain.J;

  // First Piola-Kirchhoff stress P = F S (S itself when strains are small), times V.
  const Pack stress[3][3] = {{S[0], S[3], S[5]}, {S[3], S[1], S[4]}, {S[5], S[4], S[2]}};
  for (int i = 0; i < 3; ++i) {
    Pack P[3];
    for (int I = 0; I < 3; ++I) {
      if constexpr (Law::small_strain) {
        P[I] = V * stress[i][I];
      } else {
        P[I] = V * (k.F[i][0] * stress[0][I] + k.F[i][1] * stress[1][I] + k.F[i][2] * stress[2][I]);
      }
    }
    for (int a = 0; a < 4; ++a)
      result.residual[4 * a + i] =
          P[0] * k.gradient[a][0] + P[1] * k.gradient[a][1] + P[2] * k.gradient[a][2];
  }
}

constexpr int entryOf(int row, int column) {
  const int i = row < column ? row : column, j = row < column ? column : row;
  return i * local_unknowns - i * (i - 1) / 2 + (j - i);
}

template <class Law, bool mixed>
PALPATE_INLINE void computeTangent(const Law& law, const ElementParameters& parameters,
                                   const BatchGeometry& geometry, const Kinematics& k,
                                   const ConstraintValues& constraint, const Pack (&S)[6],
                                   BatchTangent& tangent) {
  const Pack V = geometry.volume;
  const double scale = parameters.pressure_scale;
  Pack D[6][6];
  law.tangent(k.strain, D);
  if constexpr (mixed) {
    const Pack p = scale * k.q_mean;
    const Pack pa = p * constraint.a, pb = p * constraint.b;
    Pack Ci[3][3];
    for (int I = 0; I < 3; ++I)
      for (int K = 0; K < 3; ++K) Ci[I][K] = k.strain.C_inverse[voigt_of[I][K]];
    for (int v = 0; v < 6; ++v)
      for (int w = v; w < 6; ++w) {
        const int I = voigt_row[v], K = voigt_column[v], M = voigt_row[w], N = voigt_column[w];
        D[v][w] += pa * (Ci[I][M] * Ci[K][N] + Ci[I][N] * Ci[K][M]) - pb * Ci[I][K] * Ci[M][N];
        D[w][v] = D[v][w];
      }
  }

  // B maps nodal displacements to Voigt strain. Three nodes suffice: rigid translations are in the kernel.
  Pack B[6][9];
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i)
      for (int v = 0; v < 6; ++v) {
        const int I = voigt_row[v], K = voigt_column[v];
        Pack value;
        if constexpr (Law::small_strain) {
          value = (i == I ? 1.0 : 0.0) * k.gradient[a][K];
          if (v >= 3) value += (i == K ? 1.0 : 0.0) * k.gradient[a][I];
        } else {
          value = k.F[i][I] * k.gradient[a][K];
          if (v >= 3) value += k.F[i][K] * k.gradient[a][I];
        }
        B[v][3 * a + i] = value;
      }
  Pack geometric[3][3] = {};
  if constexpr (!Law::small_strain) {
    const Pack stress[3][3] = {{S[0], S[3], S[5]}, {S[3], S[1], S[4]}, {S[5], S[4], S[2]}};
    for (int a = 0; a < 3; ++a) {
      Pack t[3];
      for (int I = 0; I < 3; ++I)
        t[I] = V * (stress[I][0] * k.gradient[a][0] + stress[I][1] * k.gradient[a][1] +
                    stress[I][2] * k.gradient[a][2]);
      for (int b = a; b < 3; ++b) {
        geometric[a][b] = t[0] * k.gradient[b][0] + t[1] * k.gradient[b][1] + t[2] * k.gradient[b][2];
        geometric[b][a] = geometric[a][b];
      }
    }
  }
  Pack K[9][9];
  for (int column = 0; column < 9; ++column) {
    Pack DB[6];
    for (int v = 0; v < 6; ++v) {
      DB[v] = D[v][0] * B[0][column];
      for (int w = 1; w < 6; ++w) DB[v] += D[v][w] * B[w][column];
      DB[v] *= V;
    }
    for (int row = 0; row <= column; ++row) {
      Pack sum = B[0][row] * DB[0];
      for (int v = 1; v < 6; ++v) sum += B[v][row] * DB[v];
      if (row % 3 == column % 3) sum += geometric[row / 3][column / 3];
      K[row][column] = sum;
      K[column][row] = sum;
    }
  }
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i) {
      for (int b = a; b < 3; ++b)
        for (int j = (b == a ? i : 0); j < 3; ++j)
          tangent.entry[entryOf(4 * a + i, 4 * b + j)] = K[3 * a + i][3 * b + j];
      for (int j = 0; j < 3; ++j)
        tangent.entry[entryOf(4 * a + i, 12 + j)] =
            -(K[3 * a + i][j] + K[3 * a + i][3 + j] + K[3 * a + i][6 + j]);
    }
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      Pack sum = Pack{};
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) sum += K[3 * a + i][3 * b + j];
      tangent.entry[entryOf(12 + i, 12 + j)] = sum;
    }

  // Coupling -V/4 a F C^-1 grad N_a (the same for the element's four pressures), and the projection.
  for (int a = 0; a < 4; ++a)
    for (int i = 0; i < 3; ++i) {
      Pack coupling = Pack{};
      if constexpr (mixed) {
        for (int I = 0; I < 3; ++I) {
          Pack F_C_inverse = k.F[i][0] * k.strain.C_inverse[voigt_of[0][I]];
          F_C_inverse += k.F[i][1] * k.strain.C_inverse[voigt_of[1][I]];
          F_C_inverse += k.F[i][2] * k.strain.C_inverse[voigt_of[2][I]];
          coupling += F_C_inverse * k.gradient[a][I];
        }
        coupling *= -0.25 * scale * V * constraint.a;
      }
      for (int b = 0; b < 4; ++b) tangent.entry[entryOf(4 * a + i, 4 * b + 3)] = coupling;
    }
  const double stabilization = parameters.stabilization * scale * scale;
  for (int a = 0; a < 4; ++a)
    for (int b = a; b < 4; ++b)
      tangent.entry[entryOf(4 * a + 3, 4 * b + 3)] = -stabilization * projection(a, b) * V;
}

template <class Law, bool mixed, bool with_tangent>
void evaluateBatch(const Law& law, const ElementParameters& parameters, const BatchGeometry& geometry,
                   const double* u, const double* q, BatchResult& result, BatchTangent* tangent) {
  Kinematics k;
  ConstraintValues constraint;
  Pack S[6];
  deform<Law::small_strain, mixed>(geometry, u, q, k);
  computeResidual<Law, mixed>(law, parameters, geometry, k, result, constraint, S);
  if constexpr (with_tangent)
    computeTangent<Law, mixed>(law, parameters, geometry, k, constraint, S, *tangent);
}

template <bool with_tangent>
void evaluate(const ElementParameters& p, const BatchGeometry& geometry, const double* u, const double* q,
              BatchResult& result, BatchTangent* tangent) {
  switch (p.law) {
    case LawName::linear:
      return evaluateBatch<Linear, false, with_tangent>({{p.lambda, p.mu}}, p, geometry, u, q, result,
                                                        tangent);
    case LawName::st_venant_kirchhoff:
      return evaluateBatch<StVenantKirchhoff, false, with_tangent>({p.lambda, p.mu}, p, geometry, u, q,
                                                                   result, tangent);
    case LawName::modified_st_venant_kirchhoff:
      return evaluateBatch<StVenantKirchhoff, true, with_tangent>({p.lambda, p.mu}, p, geometry, u, q, result,
                                                                  tangent);
    case LawName::mooney_rivlin:
      return evaluateBatch<MooneyRivlin, true, with_tangent>({p.c10, p.c01}, p, geometry, u, q, result,
                                                             tangent);
    default:
      break;
  }
}

void residualKernel(const ElementParameters& p, const BatchGeometry& geometry, const double* u,
                    const double* q, BatchResult& result) {
  evaluate<false>(p, geometry, u, q, result, nullptr);
}

void tangentKernel(const ElementParameters& p, const BatchGeometry& geometry, const double* u,
                   const double* q, BatchResult& result, BatchTangent& tangent) {
  evaluate<true>(p, geometry, u, q, result, &tangent);
}

}  // namespace
}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
