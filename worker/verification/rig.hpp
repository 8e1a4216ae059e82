#pragma once

#include <cstdint>
#include <string_view>

#include "worker/solver/newton.hpp"
#include "worker/verification/case.hpp"
#include "worker/verification/meshes.hpp"

/// What problems are written with, and all that their files need to include: cases and rows, bodies
/// with their materials, and what holds, loads, solves and measures them.
namespace palpate::verification {

/// One of the choices a scene has, as [discretization] would say it.
inline constexpr Discretization taylor_hood = {DisplacementSpace::p2, PressureSpace::p1};
inline constexpr Discretization stabilized = {DisplacementSpace::p1, PressureSpace::p1_stabilized};
inline constexpr Discretization equal_order = {DisplacementSpace::p1, PressureSpace::p1};
inline constexpr Discretization p1_displacement = {DisplacementSpace::p1, PressureSpace::none};
inline constexpr Discretization p2_displacement = {DisplacementSpace::p2, PressureSpace::none};

/// The soft tissue that most problems are made of; c10 and c01 are the paper's.
namespace tissue {
inline constexpr double c10 = 1300, c01 = 1280;        ///< Pa, Mooney-Rivlin
inline constexpr double mu = 5160, bulk = 20000;       ///< Pa, neo-Hookean
inline constexpr double young = 15480, poisson = 0.3;  ///< Pa, -, St. Venant-Kirchhoff
}  // namespace tissue

/// Materials of three laws, in Pa; without `bulk` exactly incompressible.
Material mooneyRivlin(double c10 = tissue::c10, double c01 = tissue::c01);
Material neoHookean(double mu, std::optional<double> bulk = {});
Material stVenantKirchhoff(double young = tissue::young, double poisson = tissue::poisson);

/// A body of one material on a linear mesh, which gets its mid-edge nodes here when the
/// displacement is P2. Nothing is held or loaded.
BodyModel bodyOf(Mesh mesh, const Discretization& discretization, const Material& material);

/// Holds the components of `axes` ("x", "yz", ...) of these nodes, or of a node group of the mesh,
/// where the state has them.
void hold(BodyModel& body, const std::vector<std::int32_t>& nodes, std::string_view axes);
void hold(BodyModel& body, const std::string& group, std::string_view axes);

/// Holds what lies in the planes x = 0, y = 0 and z = 0 there: the body is a part of a symmetric
/// one.
void holdSymmetryPlanes(BodyModel& body);

/// Sorted nodes, the mid-edge ones too, in the plane where coordinate `axis` is `value` (to 1e-9 of
/// the body's size).
std::vector<std::int32_t> nodesInPlane(const Mesh& mesh, int axis, double value);

/// The triangles of the surface whose nodes are all where `chosen` says (of their rest positions).
std::vector<Triangle> facesWhere(const Mesh& mesh,
                                 const std::function<bool(const Eigen::Vector3d& X)>& chosen);

/// The rest state of `system` with every node displaced by u(X), metres.
State displaced(const System& system,
                const std::function<Eigen::Vector3d(const Eigen::Vector3d& X)>& u);

/// One force per node, newtons.
using NodalForces = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// A body with its system and solver. At most one at a time in a process (LinearSolver).
class Rig {
 public:
  explicit Rig(const BodyModel& body);

  const System& system() const { return system_; }
  void setLoadFactor(double factor) { system_.setLoadFactor(factor); }

  /// The equilibrium that Newton finds from `start`, which has the held components, and the tool if
  /// there is one, where they are to be. What happened is in NewtonResult::cause.
  NewtonResult seek(State start, const Eigen::Vector3d& tool = Eigen::Vector3d::Zero());
  /// The same; Error when it does not converge.
  NewtonResult equilibrium(State start, const Eigen::Vector3d& tool = Eigen::Vector3d::Zero());

  /// The equilibrium from rest with the loads in `steps` equal parts, each from the one before.
  /// Error when one of them does not converge.
  NewtonResult loadInSteps(int steps);

  /// MUMPS's count of negative eigenvalues of the tangent at `state`.
  std::int32_t negativeEigenvalues(const State& state);

  NewtonOptions options = {.max_iterations = 200,
                           .max_factorizations = 60,
                           .max_halvings = 12,
                           .absolute_tolerance = 1e-12};

 private:
  System system_;
  TangentSolver solver_;
};

/// What must be exerted on each node to keep `body` in this state, whoever does it, supports or
/// loads: the derivative of the stored energy. Zero to the tolerance where the body is free.
NodalForces nodalForces(const BodyModel& body, const State& state);

/// Mean of the nominal stress P = F S over the body, Pa: sum over the nodes of f X^T / volume.
Eigen::Matrix3d meanStress(const BodyModel& body, const State& state);

}  // namespace palpate::verification
