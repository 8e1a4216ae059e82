#pragma once

#include <cstdint>
#include <string_view>

#include "tests/verification/case.hpp"
#include "tests/verification/meshes.hpp"
#include "worker/solver/newton.hpp"

/// Functions that verification problems share. They make bodies with materials, supports and loads,
/// solve, and measure.
namespace palpate::verification {

/// Discretizations, as a scene's [discretization] chooses them.
inline constexpr Discretization taylor_hood = {DisplacementSpace::p2, PressureSpace::p1};
inline constexpr Discretization stabilized = {DisplacementSpace::p1, PressureSpace::p1_stabilized};
inline constexpr Discretization equal_order = {DisplacementSpace::p1, PressureSpace::p1};
inline constexpr Discretization p1_displacement = {DisplacementSpace::p1, PressureSpace::none};
inline constexpr Discretization p2_displacement = {DisplacementSpace::p2, PressureSpace::none};

/// The soft tissue of most problems. c10 and c01 are from Peterlik et al. (2010).
namespace tissue {
inline constexpr double c10 = 1300, c01 = 1280;        ///< Pa, Mooney-Rivlin
inline constexpr double mu = 5160, bulk = 20000;       ///< Pa, neo-Hookean
inline constexpr double young = 15480, poisson = 0.3;  ///< Pa, -, St. Venant-Kirchhoff
}  // namespace tissue

/// Return a material of one of three laws, with moduli in Pa. Without `bulk`, neo-Hookean is
/// exactly incompressible.
Material mooneyRivlin(double c10 = tissue::c10, double c01 = tissue::c01);
Material neoHookean(double mu, std::optional<double> bulk = {});
Material stVenantKirchhoff(double young = tissue::young, double poisson = tissue::poisson);

/// Returns a body of one material, without supports or loads. `mesh` is linear; if the displacement
/// is P2, this function adds the mid-edge nodes.
BodyModel bodyOf(Mesh mesh, const Discretization& discretization, const Material& material);

/// Fix the displacement components `axes` ("x", "yz", ...) of these nodes, or of a node group of
/// the mesh. A solve keeps the values that these components have in its start.
void hold(BodyModel& body, const std::vector<std::int32_t>& nodes, std::string_view axes);
void hold(BodyModel& body, const std::string& group, std::string_view axes);

/// Keeps nodes of the planes x = 0, y = 0 and z = 0 within their planes. The body then represents a
/// symmetric body, of which it is one part.
void holdSymmetryPlanes(BodyModel& body);

/// Returns the nodes, including mid-edge nodes, whose coordinate `axis` is `value` (to 1e-9 of the
/// body's size), sorted.
std::vector<std::int32_t> nodesInPlane(const Mesh& mesh, int axis, double value);

/// Returns the surface triangles for which `chosen` accepts the rest position of each corner.
std::vector<Triangle> facesWhere(const Mesh& mesh,
                                 const std::function<bool(const Eigen::Vector3d& X)>& chosen);

/// Returns the rest state of `system` with every node displaced by u(X), metres.
State displaced(const System& system,
                const std::function<Eigen::Vector3d(const Eigen::Vector3d& X)>& u);

/// One force per node, newtons.
using NodalForces = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// A body with its system and solver. A process may have only one at a time (LinearSolver).
class Rig {
 public:
  explicit Rig(const BodyModel& body);

  const System& system() const { return system_; }
  void setLoadFactor(double factor) { system_.setLoadFactor(factor); }

  /// Returns the equilibrium that Newton finds from `start`, or the state in which it failed with
  /// NewtonResult::cause. In `start`, the fixed components, and the tool if there is one, must
  /// already have their final positions.
  NewtonResult seek(State start, const Eigen::Vector3d& tool = Eigen::Vector3d::Zero());
  /// The same as seek(), but throws an Error if Newton does not converge.
  NewtonResult equilibrium(State start, const Eigen::Vector3d& tool = Eigen::Vector3d::Zero());

  /// Returns the equilibrium under the full loads. They are applied from rest in `steps` equal
  /// parts, and each part starts from the equilibrium of the previous one. Error if a part does not
  /// converge.
  NewtonResult loadInSteps(int steps);

  /// Returns MUMPS's count of negative eigenvalues of the tangent at `state`.
  std::int32_t negativeEigenvalues(const State& state);

  NewtonOptions options = {.max_iterations = 200,
                           .max_factorizations = 60,
                           .max_halvings = 12,
                           .absolute_tolerance = 1e-12};

 private:
  System system_;
  TangentSolver solver_;
};

/// Returns the force on each node, from supports and loads together, that keeps `body` in this
/// state. It is the derivative of the stored energy, and zero to the solver's tolerance at nodes
/// that are neither held nor loaded.
NodalForces nodalForces(const BodyModel& body, const State& state);

/// Returns the mean of the nominal stress P = F S over the body, Pa. It is computed as the sum of f
/// X^T / volume over the nodes, with f the nodal force and X the rest position.
Eigen::Matrix3d meanStress(const BodyModel& body, const State& state);

}  // namespace palpate::verification
