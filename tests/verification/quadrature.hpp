#pragma once

#include <Eigen/Core>
#include <functional>

#include "common/mesh/mesh.hpp"

namespace palpate::verification {

/// An integration point in an element, with the element's shape functions at this point. It is
/// computed without the element kernels, which verification checks with it.
struct IntegrationPoint {
  double weight;      ///< m^3
  Eigen::Vector3d X;  ///< metres, at rest
  int nodes;          ///< 4, or 10 on a quadratic mesh
  std::array<std::int32_t, 10> node;
  std::array<double, 10> N;
  std::array<Eigen::Vector3d, 10> gradient;  ///< of N, 1/m
  std::array<double, 4> vertex_N;            ///< linear shape functions of the four vertices
};

/// Calls `visit` at the points of a rule of degree 7 in every tetrahedron (Gauss-Legendre,
/// collapsed from the cube), in a fixed order.
void integrate(const Mesh& mesh, const std::function<void(const IntegrationPoint&)>& visit);

}  // namespace palpate::verification
