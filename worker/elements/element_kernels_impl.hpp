// Included once per CPU family, with the compiler flags of that family. The including file defines
// PALPATE_KERNEL_FAMILY (the family's name), PALPATE_KERNEL_NAMESPACE and PALPATE_KERNELS (a
// namespace and a variable that only this file uses). Do not use inline functions of other headers
// here: the linker would keep one copy, compiled for one family, and use it for all.
#include "worker/elements/linear_tetrahedron.hpp"
#include "worker/elements/shape_functions.hpp"

// At a quadrature point, any element behaves like a linear tetrahedron. With barycentric
// coordinates x_b and shape functions N_a(x),
//
//   F = I + sum_a u_a (x) grad N_a = I + sum_b d_b (x) grad x_b,   d_b = sum_a dN_a/dx_b u_a
//
// So the energy density is that of a linear tetrahedron with vertex displacements d. All nonlinear
// terms are computed for that tetrahedron (vertexForces, vertexStiffness). Derivatives with respect
// to u are linear combinations of those with respect to d (atNode), with fixed coefficients.
namespace palpate::PALPATE_KERNEL_NAMESPACE {
namespace {

using Point = double[4];  ///< barycentric coordinates

template <class Displacement_, class Pressure_>
struct Element {
  using Displacement = Displacement_;
  using Pressure = Pressure_;
  static constexpr bool has_pressure = Pressure::nodes > 0;
  static constexpr bool one_point = Displacement::rule.points == 1;
  static constexpr int first_pressure = 3 * Displacement::nodes;
  static constexpr int unknowns = first_pressure + Pressure::nodes;

  /// Returns the index of a tangent entry in the upper triangle, stored row by row; row <= column.
  static constexpr int entryOf(int row, int column) {
    return row * unknowns - row * (row - 1) / 2 + (column - row);
  }
};

/// Adds to `d` the vertex displacements of the linear tetrahedron that replaces the element at x.
template <class Space>
PALPATE_INLINE void addAtVertices(const Point& x, const Pack (&nodal)[Space::nodes][3],
                                  PerVertex& d) {
  for (int a = 0; a < Space::nodes; ++a)
    for (int e = 0; e < Space::ends; ++e)
      for (int i = 0; i < 3; ++i) d[Space::end[a][e]][i] += Space::slope(a, e, x) * nodal[a][i];
}

/// Returns the derivative with respect to component i of u_a, the displacement of node a. `vertex`
/// has the derivatives with respect to the vertex displacements of addAtVertices().
template <class Space>
PALPATE_INLINE Pack atNode(int a, int i, const Point& x, const PerVertex& vertex) {
  Pack sum = Space::slope(a, 0, x) * vertex[Space::end[a][0]][i];
  for (int e = 1; e < Space::ends; ++e) sum += Space::slope(a, e, x) * vertex[Space::end[a][e]][i];
  return sum;
}

/// Adds the contribution of a quadrature point to a sum. If the rule has a single point, the
/// contribution is the sum.
template <class Element>
PALPATE_INLINE void addShare(Pack& sum, Pack share) {
  if constexpr (Element::one_point) {
    sum = share;
  } else {
    sum += share;
  }
}

template <class Element>
PALPATE_INLINE void addForces(const Point& x, const PerVertex& force, BatchResult& result) {
  using U = typename Element::Displacement;
  for (int a = 0; a < U::nodes; ++a)
    for (int i = 0; i < 3; ++i)
      addShare<Element>(result.residual[3 * a + i], atNode<U>(a, i, x, force));
}

template <class Element>
PALPATE_INLINE void addStiffness(const Point& x, const VertexStiffness& k, BatchTangent& tangent) {
  using U = typename Element::Displacement;
  for (int a = 0; a < U::nodes; ++a)
    for (int i = 0; i < 3; ++i) {
      PerVertex row;  // d(component i of the force on node a)/dd
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

/// Adds the tangent entries that couple displacements with pressures. `force` has the derivatives
/// of -scale * weight * c(J) with respect to d, per unit of q.
template <class Element>
PALPATE_INLINE void addCoupling(const Point& x, const PerVertex& force, BatchTangent& tangent) {
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

/// Adds the terms that are quadratic in the pressure, - integral of p^2/(2 bulk) - V alpha/(2 mu)
/// <(p - <p>)^2>.
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

/// Displacements and pressures at the nodes of a batch.
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
      for (int l = 0; l < lanes; ++l) q[b][l] = all_q[geometry.pressure[b][l]];
  }

  PALPATE_INLINE Pack pressureAt(const Point& x, double scale) const {
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
    const Point& x = U::rule.point[n];
    const Pack weight = U::rule.weight[n] * geometry.volume;
    PerVertex d = {}, force;
    Deformation deformation;
    Response response;
    addAtVertices<U>(x, nodal.u, d);
    deform(gradients, d, small_strain, deformation);
    respond<with_tangent>(parameters, geometry, nodal.pressureAt(x, scale), deformation.strain,
                          response);

    const Pack J = deformation.strain.J;
    result.det_F = J >= result.det_F ? result.det_F : J;  // keeps a NaN
    addShare<Element>(result.energy, weight * response.energy);
    vertexForces(gradients, deformation.F, response.S, weight, force);
    addForces<Element>(x, force, result);
    for (int b = 0; b < Q::nodes; ++b)
      addShare<Element>(result.residual[Element::first_pressure + b],
                        -scale * Q::value(b, x) * weight * response.constraint.value);
    if constexpr (with_tangent) {
      VertexStiffness k;
      vertexStiffness(gradients, deformation.F, response, small_strain, weight, k);
      addStiffness<Element>(x, k, *tangent);
      if constexpr (Element::has_pressure) {
        // The constraint c(J) is treated as an energy density. Its stress is J dc/dJ C^-1.
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
void evaluateAs(const ElementParameters& p, const BatchGeometry& geometry, const double* u,
                const double* q, BatchResult& result, BatchTangent* tangent) {
  const auto run = [&](auto element) {
    evaluateBatch<decltype(element), with_tangent>(p, geometry, u, q, result, tangent);
  };
  const bool quadratic = p.displacement == DisplacementSpace::p2;
  switch (p.pressure) {
    case PressureSpace::none:
      return quadratic ? run(Element<P2, NoSpace>{}) : run(Element<P1, NoSpace>{});
    case PressureSpace::p1:
    case PressureSpace::p1_stabilized:
      return quadratic ? run(Element<P2, P1>{}) : run(Element<P1, P1>{});
    case PressureSpace::p2: return run(Element<P2, P2>{});
  }
}

void evaluate(const ElementParameters& p, const BatchGeometry& geometry, const double* u,
              const double* q, BatchResult& result, BatchTangent* tangent) {
  return tangent ? evaluateAs<true>(p, geometry, u, q, result, tangent)
                 : evaluateAs<false>(p, geometry, u, q, result, nullptr);
}

}  // namespace
}  // namespace palpate::PALPATE_KERNEL_NAMESPACE

namespace palpate {

extern const ElementKernels PALPATE_KERNELS;
const ElementKernels PALPATE_KERNELS = {PALPATE_KERNEL_FAMILY, PALPATE_KERNEL_NAMESPACE::evaluate};

}  // namespace palpate
