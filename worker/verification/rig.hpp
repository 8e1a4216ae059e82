#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "worker/solver/body_model.hpp"
#include "worker/solver/newton.hpp"
#include "worker/solver/system.hpp"
#include "worker/solver/tangent_solver.hpp"

/// Bodies for verification problems, and what holds, loads and measures them.
namespace palpate::verification {

/// One of the choices a scene has, as [discretization] would say it.
inline constexpr Discretization taylor_hood = {DisplacementSpace::p2, PressureSpace::p1,
                                               Constraint::ln_det_F};
inline constexpr Discretization stabilized = {DisplacementSpace::p1, PressureSpace::p1_stabilized,
                                              Constraint::ln_det_F};
inline constexpr Discretization equal_order = {DisplacementSpace::p1, PressureSpace::p1,
                                               Constraint::ln_det_F};
inline constexpr Discretization p1_displacement = {DisplacementSpace::p1, PressureSpace::none,
                                                   Constraint::ln_det_F};
inline constexpr Discretization p2_displacement = {DisplacementSpace::p2, PressureSpace::none,
                                                   Constraint::ln_det_F};

Material mooneyRivlin(double c10 = 1300, double c01 = 1280);  ///< the paper's constants
Material neoHookean(double mu);
Material stVenantKirchhoff(double young, double poisson);

/// A body of one material on a linear mesh, which gets its mid-edge nodes here when the
/// displacement is P2. Nothing is held or loaded.
BodyModel bodyOf(Mesh mesh, const Discretization& discretization, const Material& material);

/// Holds the components of `axes` ("x", "yz", ...) of these nodes, or of a node group of the mesh,
/// where the state has them.
void hold(BodyModel& body, const std::vector<std::int32_t>& nodes, std::string_view axes);
void hold(BodyModel& body, const std::string& group, std::string_view axes);

/// Sorted nodes, the mid-edge ones too, in the plane where coordinate `axis` is `value` (to 1e-9 of
/// the body's size).
std::vector<std::int32_t> nodesInPlane(const Mesh& mesh, int axis, double value);

/// The triangles of the surface whose nodes are all where `chosen` says (of their rest positions).
std::vector<Triangle> facesWhere(const Mesh& mesh,
                                 const std::function<bool(const Eigen::Vector3d& X)>& chosen);

/// Displacement of a node in a state, metres.
Eigen::Vector3d displacementOf(const State& state, std::int32_t node);
void setDisplacement(State& state, std::int32_t node, const Eigen::Vector3d& u);

/// The rest state of `system` with every node displaced by u(X), metres.
State displaced(const System& system,
                const std::function<Eigen::Vector3d(const Eigen::Vector3d& X)>& u);

/// One force per node, newtons.
using NodalForces = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// A body with its system and solver. At most one at a time in a process (LinearSolver).
class Rig {
 public:
  explicit Rig(const BodyModel& body);

  const BodyModel& body() const { return system_.model(); }
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

/// Which unknown is which: number k stands, plus one, at the component of the state that is unknown
/// k; zero at those that are none.
State numbering(const System& system);

}  // namespace palpate::verification
