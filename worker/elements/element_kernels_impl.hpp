// Included once per CPU family, with PALPATE_KERNEL_NAMESPACE set to a name of its own and the
// compiler flags of that family. Nothing here may be an inline function of another header: the
// linker would keep one family's copy for all.
#include "worker/elements/element_kernels.hpp"
#include "worker/elements/point_response.hpp"
#include "worker/elements/shape_functions.hpp"

// Every element is, at each quadrature point, a linear tetrahedron. With barycentric coordinates
// x_b and shape functions N_a(x),
//
//   F = I + sum_a u_a (x) grad N_a = I + sum_b d_b (x) grad x_b,   d_b = sum_a dN_a/dx_b u_a
//
// so its energy is that of a tetrahedron whose vertices are displaced by d. All that is nonlinear
// is computed for that one (vertexForces, vertexStiffness); derivatives with respect to u are
// combinations of those with respect to d (atNode), the same in all elements.
namespace palpate::PALPATE_KERNEL_NAMESPACE {
namespace {

template <class Displacement_, class Pressure_>
struct Element {
  using Displacement = Displacement_;
  using Pressure = Pressure_;
  static constexpr bool has_pressure = Pressure::nodes > 0;
  static constexpr bool one_point = Displacement::rule.points == 1;
  static constexpr int first_pressure = 3 * Displacement::nodes;
  static constexpr int unknowns = first_pressure + Pressure::nodes;

  /// Place of a pair in the upper triangle of the tangent.
  static constexpr int entryOf(int row, int column) {
    return row * unknowns - row * (row - 1) / 2 + (column - row);
  }
};

struct Gradients {
  Pack of[4][3];  ///< of[b][I] = dx_b/dX_I

  PALPATE_INLINE explicit Gradients(const BatchGeometry& geometry) {
    for (int I = 0; I < 3; ++I) {
      for (int b = 0; b < 3; ++b) of[b][I] = geometry.gradient[b][I];
      of[3][I] = -(of[0][I] + of[1][I] + of[2][I]);
    }
  }
};

/// d at the point x.
template <class Space>
PALPATE_INLINE void atVertices(const double (&x)[4], const Pack (&nodal)[Space::nodes][3],
                               Pack (&d)[4][3]) {
  for (auto& vertex : d)
    for (Pack& component : vertex) component = Pack{};
  for (int a = 0; a < Space::nodes; ++a)
    for (int e = 0; e < Space::ends; ++e)
      for (int i = 0; i < 3; ++i) d[Space::end[a][e]][i] += Space::slope(a, e, x) * nodal[a][i];
}

/// The derivative with respect to component i of u_a, from those with respect to d.
template <class Space>
PALPATE_INLINE Pack atNode(int a, int i, const double (&x)[4], const Pack (&vertex)[4][3]) {
  Pack sum = Space::slope(a, 0, x) * vertex[Space::end[a][0]][i];
  for (int e = 1; e < Space::ends; ++e) sum += Space::slope(a, e, x) * vertex[Space::end[a][e]][i];
  return sum;
}

PALPATE_INLINE void deform(const Gradients& gradients, const Pack (&d)[4][3], bool small_strain,
                           Deformation& deformation) {
  Pack grad_u[3][3] = {};
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
    // From grad u, not from F^T F - I: no cancellation at small strain.
    Pack e = grad_u[I][K] + grad_u[K][I];
    if (!small_strain)
      for (int i = 0; i < 3; ++i) e += grad_u[i][I] * grad_u[i][K];
    deformation.strain.e[v] = v < 3 ? 0.5 * e : e;
  }
  if (small_strain)
    for (int i = 0; i < 3; ++i)
      for (int I = 0; I < 3; ++I) F[i][I] = Pack{} + (i == I ? 1.0 : 0.0);
}

/// A stress in Voigt order as a matrix.
struct Stress {
  Pack of[3][3];

  PALPATE_INLINE explicit Stress(const Pack (&S)[6]) {
    for (int I = 0; I < 3; ++I)
      for (int K = 0; K < 3; ++K) of[I][K] = S[voigt_of[I][K]];
  }
};

/// Derivatives with respect to d of weight * (an energy density with stress S): P grad x_b, with P
/// = F S the first Piola-Kirchhoff stress.
PALPATE_INLINE void vertexForces(const Gradients& gradients, const Pack (&F)[3][3],
                                 const Pack (&S)[6], Pack weight, Pack (&force)[4][3]) {
  const Stress stress(S);
  for (int i = 0; i < 3; ++i) {
    Pack P[3];
    for (int I = 0; I < 3; ++I)
      P[I] = weight *
             (F[i][0] * stress.of[0][I] + F[i][1] * stress.of[1][I] + F[i][2] * stress.of[2][I]);
    for (int b = 0; b < 4; ++b)
      force[b][i] =
          P[0] * gradients.of[b][0] + P[1] * gradients.of[b][1] + P[2] * gradients.of[b][2];
  }
}

/// grad x_b . S grad x_c of the first three vertices, times weight: what turning adds to the
/// stiffness.
PALPATE_INLINE void geometricStiffness(const Gradients& gradients, const Pack (&S)[6], Pack weight,
                                       Pack (&geometric)[3][3]) {
  const Stress stress(S);
  for (int b = 0; b < 3; ++b) {
    Pack t[3];
    for (int I = 0; I < 3; ++I)
      t[I] = weight * (stress.of[I][0] * gradients.of[b][0] + stress.of[I][1] * gradients.of[b][1] +
                       stress.of[I][2] * gradients.of[b][2]);
    for (int c = b; c < 3; ++c) {
      geometric[b][c] =
          t[0] * gradients.of[c][0] + t[1] * gradients.of[c][1] + t[2] * gradients.of[c][2];
      geometric[c][b] = geometric[b][c];
    }
  }
}

/// Second derivatives of weight * energy with respect to d: k[b][i][c][j].
PALPATE_INLINE void vertexStiffness(const Gradients& gradients, const Pack (&F)[3][3],
                                    const Response& response, bool small_strain, Pack weight,
                                    Pack (&k)[4][3][4][3]) {
  // B maps vertex displacements to Voigt strain. Three vertices suffice: translations do not
  // strain.
  Pack B[6][9];
  for (int b = 0; b < 3; ++b)
    for (int i = 0; i < 3; ++i)
      for (int v = 0; v < 6; ++v) {
        const int I = voigt_row[v], K = voigt_column[v];
        Pack value = F[i][I] * gradients.of[b][K];
        if (v >= 3) value += F[i][K] * gradients.of[b][I];
        B[v][3 * b + i] = value;
      }
  Pack geometric[3][3] = {};
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

/// Adds the share of a quadrature point to a sum; the share of the only point is the sum.
template <class Element>
PALPATE_INLINE void addShare(Pack& sum, Pack share) {
  if constexpr (Element::one_point) {
    sum = share;
  } else {
    sum += share;
  }
}

template <class Element>
PALPATE_INLINE void addForces(const double (&x)[4], const Pack (&force)[4][3],
                              BatchResult& result) {
  using U = typename Element::Displacement;
  for (int a = 0; a < U::nodes; ++a)
    for (int i = 0; i < 3; ++i)
      addShare<Element>(result.residual[3 * a + i], atNode<U>(a, i, x, force));
}

template <class Element>
PALPATE_INLINE void addStiffness(const double (&x)[4], const Pack (&k)[4][3][4][3],
                                 BatchTangent& tangent) {
  using U = typename Element::Displacement;
  for (int a = 0; a < U::nodes; ++a)
    for (int i = 0; i < 3; ++i) {
      Pack row[4][3];  // derivatives of the force i on node a with respect to d
      for (int b = 0; b < 4; ++b)
        for (int j = 0; j < 3; ++j) {
          row[b][j] = U::slope(a, 0, x) * k[U::end[a][0]][i][b][j];
          for (int e = 1; e < U::ends; ++e)
            row[b][j] += U::slope(a, e, x) * k[U::end[a][e]][i][b][j];
        }
      for (int b = a; b < U::nodes; ++b)
        for (int j = (b == a ? i : 0); j < 3; ++j)
          addShare<Element>(tangent.entry[Element::entryOf(3 * a + i, 3 * b + j)],
                            atNode<U>(b, j, x, row));
    }
}

/// force: derivatives of -scale * weight * c(J) with respect to d, those of a unit of q.
template <class Element>
PALPATE_INLINE void addCoupling(const double (&x)[4], const Pack (&force)[4][3],
                                BatchTangent& tangent) {
  using U = typename Element::Displacement;
  using Q = typename Element::Pressure;
  for (int a = 0; a < U::nodes; ++a)
    for (int i = 0; i < 3; ++i) {
      const Pack nodal = atNode<U>(a, i, x, force);
      for (int b = 0; b < Q::nodes; ++b)
        addShare<Element>(tangent.entry[Element::entryOf(3 * a + i, Element::first_pressure + b)],
                          Q::value(b, x) * nodal);
    }
}

/// The terms that are quadratic in the pressure, - integral of p^2/(2 bulk) - V alpha/(2 mu) <(p -
/// <p>)^2>.
template <class Element, bool with_tangent>
PALPATE_INLINE void addPressureForm(const ElementParameters& parameters, Pack volume,
                                    const Pack* nodal_q, BatchResult& result,
                                    BatchTangent* tangent) {
  using Q = typename Element::Pressure;
  static constexpr QuadraticMeans<Q> means;
  const double square = parameters.pressure_scale * parameters.pressure_scale;
  const double compressibility = parameters.bulk > 0 ? square / parameters.bulk : 0;
  const double stabilization = square * parameters.stabilization;
  for (int a = 0; a < Q::nodes; ++a) {
    const int row = Element::first_pressure + a;
    Pack volume_change = Pack{};
    for (int b = 0; b < Q::nodes; ++b) {
      const double form =
          compressibility * means.product[a][b] + stabilization * means.deviation[a][b];
      volume_change += form * volume * nodal_q[b];
      if constexpr (with_tangent)
        if (b >= a)
          tangent->entry[Element::entryOf(row, Element::first_pressure + b)] = -form * volume;
    }
    result.residual[row] -= volume_change;
    result.energy -= 0.5 * volume_change * nodal_q[a];
  }
}

/// Nodal values of a batch.
template <class Element>
struct Unknowns {
  using U = typename Element::Displacement;
  using Q = typename Element::Pressure;
  Pack u[U::nodes][3];
  Pack q[Element::has_pressure ? Q::nodes : 1];

  PALPATE_INLINE Unknowns(const BatchGeometry& geometry, const double* all_u, const double* all_q) {
    for (int a = 0; a < U::nodes; ++a)
      for (int i = 0; i < 3; ++i)
        for (int l = 0; l < lanes; ++l) u[a][i][l] = all_u[3 * geometry.node[a][l] + i];
    for (int b = 0; b < Q::nodes; ++b)
      for (int l = 0; l < lanes; ++l) q[b][l] = all_q[geometry.node[b][l]];
  }

  PALPATE_INLINE Pack pressureAt(const double (&x)[4], double scale) const {
    Pack p = Pack{};
    for (int b = 0; b < Q::nodes; ++b) p += scale * Q::value(b, x) * q[b];
    return p;
  }
};

template <class Element, bool with_tangent>
void evaluateBatch(const ElementParameters& parameters, const BatchGeometry& geometry,
                   const double* u, const double* q, BatchResult& result, BatchTangent* tangent) {
  using U = typename Element::Displacement;
  using Q = typename Element::Pressure;
  const bool small_strain = parameters.law == LawName::linear;
  const double scale = parameters.pressure_scale;
  const Gradients gradients(geometry);
  const Unknowns<Element> nodal(geometry, u, q);
  result.det_F = Pack{} + __builtin_inf();
  if constexpr (!Element::one_point) {
    result.energy = Pack{};
    for (int row = 0; row < Element::unknowns; ++row) result.residual[row] = Pack{};
    if constexpr (with_tangent)
      for (int entry = 0; entry < localEntries(Element::unknowns); ++entry)
        tangent->entry[entry] = Pack{};
  }
  for (int n = 0; n < U::rule.points; ++n) {
    const double(&x)[4] = U::rule.point[n];
    const Pack weight = U::rule.weight[n] * geometry.volume;
    Pack d[4][3], force[4][3];
    Deformation deformation;
    Response response;
    atVertices<U>(x, nodal.u, d);
    deform(gradients, d, small_strain, deformation);
    respond<with_tangent>(parameters, geometry, nodal.pressureAt(x, scale), deformation.strain,
                          response);

    const Pack J = deformation.strain.J;
    result.det_F = J >= result.det_F ? result.det_F : J;  // J too where it is NaN
    addShare<Element>(result.energy, weight * response.energy);
    vertexForces(gradients, deformation.F, response.S, weight, force);
    addForces<Element>(x, force, result);
    for (int b = 0; b < Q::nodes; ++b)
      addShare<Element>(result.residual[Element::first_pressure + b],
                        -scale * Q::value(b, x) * weight * response.constraint.value);
    if constexpr (with_tangent) {
      Pack k[4][3][4][3];
      vertexStiffness(gradients, deformation.F, response, small_strain, weight, k);
      addStiffness<Element>(x, k, *tangent);
      if constexpr (Element::has_pressure) {
        // The constraint is an energy density too, with the stress J c' C^-1.
        vertexForces(gradients, deformation.F, deformation.strain.C_inverse,
                     -scale * weight * response.constraint.first, force);
        addCoupling<Element>(x, force, *tangent);
      }
    }
  }
  if constexpr (Element::has_pressure)
    addPressureForm<Element, with_tangent>(parameters, geometry.volume, nodal.q, result, tangent);
}

template <bool with_tangent>
void evaluate(const ElementParameters& p, const BatchGeometry& geometry, const double* u,
              const double* q, BatchResult& result, BatchTangent* tangent) {
  const bool quadratic = p.displacement == DisplacementSpace::p2;
  switch (p.pressure) {
    case PressureSpace::none:
      return quadratic ? evaluateBatch<Element<P2, NoSpace>, with_tangent>(p, geometry, u, q,
                                                                           result, tangent)
                       : evaluateBatch<Element<P1, NoSpace>, with_tangent>(p, geometry, u, q,
                                                                           result, tangent);
    case PressureSpace::p1:
    case PressureSpace::p1_stabilized:
      return quadratic
                 ? evaluateBatch<Element<P2, P1>, with_tangent>(p, geometry, u, q, result, tangent)
                 : evaluateBatch<Element<P1, P1>, with_tangent>(p, geometry, u, q, result, tangent);
    case PressureSpace::p2:
      return evaluateBatch<Element<P2, P2>, with_tangent>(p, geometry, u, q, result, tangent);
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
