#pragma once

#include "worker/elements/point_response.hpp"

/// At a quadrature point, an element is treated as a linear tetrahedron. The functions here compute
/// its strain from the vertex displacements d, and the derivatives of its energy with respect to d,
/// for all elements of a batch at once. Every translation unit that compiles kernels gets its own
/// copy, in its own namespace.
namespace palpate::PALPATE_KERNEL_NAMESPACE {

using PerVertex = Pack[4][3];              ///< a vector per vertex
using VertexStiffness = Pack[4][3][4][3];  ///< [b][i][c][j]: component i at vertex b, j at vertex c

/// Gradients of the barycentric coordinates.
struct Gradients {
  PerVertex of;  ///< of[b][I] = dx_b/dX_I

  PALPATE_INLINE explicit Gradients(const BatchGeometry& geometry) {
    for (int I = 0; I < 3; ++I) {
      for (int b = 0; b < 3; ++b) of[b][I] = geometry.gradient[b][I];
      of[3][I] = -(of[0][I] + of[1][I] + of[2][I]);
    }
  }
};

/// Computes F, strain and det F from the vertex displacements d.
PALPATE_INLINE void deform(const Gradients& gradients, const PerVertex& d, bool small_strain,
                           Deformation& deformation) {
  Tensor grad_u = {};
  for (int i = 0; i < 3; ++i)
    for (int b = 0; b < 3; ++b) {
      const Pack difference = d[b][i] - d[3][i];
      for (int I = 0; I < 3; ++I) grad_u[i][I] += difference * gradients.of[b][I];
    }
  auto& F = deformation.F;
  for (int i = 0; i < 3; ++i)
    for (int I = 0; I < 3; ++I) F[i][I] = grad_u[i][I] + (i == I ? 1.0 : 0.0);
  deformation.strain.J = F[0][0] * (F[1][1] * F[2][2] - F[1][2] * F[2][1]) -
                         F[0][1] * (F[1][0] * F[2][2] - F[1][2] * F[2][0]) +
                         F[0][2] * (F[1][0] * F[2][1] - F[1][1] * F[2][0]);
  for (int v = 0; v < 6; ++v) {
    const int I = voigt_row[v], K = voigt_column[v];
    // Computed from grad u, not from F^T F - I, to avoid cancellation at small strain.
    Pack e = grad_u[I][K] + grad_u[K][I];
    if (!small_strain)
      for (int i = 0; i < 3; ++i) e += grad_u[i][I] * grad_u[i][K];
    deformation.strain.e[v] = v < 3 ? 0.5 * e : e;
  }
  if (small_strain)
    for (int i = 0; i < 3; ++i)
      for (int I = 0; I < 3; ++I) F[i][I] = Pack{} + (i == I ? 1.0 : 0.0);
}

/// Computes d(weight * W)/dd for an energy density W with the stress S. This is P grad x_b, where P
/// is `weight` times F S, the first Piola-Kirchhoff stress.
PALPATE_INLINE void vertexForces(const Gradients& gradients, const Tensor& F, const Voigt& S,
                                 Pack weight, PerVertex& force) {
  for (int i = 0; i < 3; ++i) {
    Pack P[3];
    for (int I = 0; I < 3; ++I)
      P[I] = weight * (F[i][0] * S[voigt_of[0][I]] + F[i][1] * S[voigt_of[1][I]] +
                       F[i][2] * S[voigt_of[2][I]]);
    for (int b = 0; b < 4; ++b)
      force[b][i] =
          P[0] * gradients.of[b][0] + P[1] * gradients.of[b][1] + P[2] * gradients.of[b][2];
  }
}

/// Computes the geometric stiffness, weight * grad x_b . S grad x_c, of the first three vertices.
/// It is the part of the tangent by which a stressed element resists rotation.
PALPATE_INLINE void geometricStiffness(const Gradients& gradients, const Voigt& S, Pack weight,
                                       Tensor& geometric) {
  for (int b = 0; b < 3; ++b) {
    Pack t[3];
    for (int I = 0; I < 3; ++I)
      t[I] = weight *
             (S[voigt_of[I][0]] * gradients.of[b][0] + S[voigt_of[I][1]] * gradients.of[b][1] +
              S[voigt_of[I][2]] * gradients.of[b][2]);
    for (int c = b; c < 3; ++c) {
      geometric[b][c] =
          t[0] * gradients.of[c][0] + t[1] * gradients.of[c][1] + t[2] * gradients.of[c][2];
      geometric[c][b] = geometric[b][c];
    }
  }
}

/// Computes k[b][i][c][j], the second derivatives of weight * energy with respect to d.
PALPATE_INLINE void vertexStiffness(const Gradients& gradients, const Tensor& F,
                                    const Response& response, bool small_strain, Pack weight,
                                    VertexStiffness& k) {
  // B maps vertex displacements to Voigt strain. The columns of three vertices suffice, because a
  // translation causes no strain.
  Pack B[6][9];
  for (int b = 0; b < 3; ++b)
    for (int i = 0; i < 3; ++i)
      for (int v = 0; v < 6; ++v) {
        const int I = voigt_row[v], K = voigt_column[v];
        Pack value = F[i][I] * gradients.of[b][K];
        if (v >= 3) value += F[i][K] * gradients.of[b][I];
        B[v][3 * b + i] = value;
      }
  Tensor geometric = {};
  if (!small_strain) geometricStiffness(gradients, response.S, weight, geometric);
  for (int column = 0; column < 9; ++column) {
    const int c = column / 3, j = column % 3;
    Pack DB[6];
    for (int v = 0; v < 6; ++v) {
      DB[v] = response.D[v][0] * B[0][column];
      for (int w = 1; w < 6; ++w) DB[v] += response.D[v][w] * B[w][column];
      DB[v] *= weight;
    }
    for (int row = 0; row <= column; ++row) {
      const int b = row / 3, i = row % 3;
      Pack sum = B[0][row] * DB[0];
      for (int v = 1; v < 6; ++v) sum += B[v][row] * DB[v];
      if (i == j) sum += geometric[b][c];
      k[b][i][c][j] = sum;
      k[c][j][b][i] = sum;
    }
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int b = 0; b < 3; ++b) {
        k[b][i][3][j] = -(k[b][i][0][j] + k[b][i][1][j] + k[b][i][2][j]);
        k[3][j][b][i] = k[b][i][3][j];
      }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) k[3][i][3][j] = -(k[0][i][3][j] + k[1][i][3][j] + k[2][i][3][j]);
}

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
