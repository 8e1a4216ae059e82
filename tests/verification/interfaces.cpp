// Bodies of two incompressible materials, with a pressure jump at the interface. A laminate
// stretched along its layers deforms homogeneously, with a different pressure in each layer. The
// strain in a stiff ball in soft tissue is uniform (Eshelby 1957).
#include <fmt/format.h>

#include <cmath>

#include "tests/verification/rig.hpp"

namespace palpate::verification {
namespace {

constexpr double mu_of_soft = tissue::mu;

/// Returns a body that is soft where `isSoft` holds for the middle of an element at rest, and
/// `contrast` times stiffer elsewhere.
BodyModel bodyOfTwo(Mesh mesh, const Discretization& discretization, double contrast,
                    const std::function<bool(const Eigen::Vector3d& X)>& isSoft) {
  BodyModel body = bodyOf(std::move(mesh), discretization, neoHookean(mu_of_soft));
  body.materials.push_back(neoHookean(contrast * mu_of_soft));
  for (std::size_t element = 0; element < body.mesh.tetrahedra.size(); ++element)
    body.region_of[element] = isSoft(middleOf(body.mesh, element)) ? 0 : 1;
  return body;
}

// ---- the laminate -----------------------------------------------------------------------------

constexpr double laminate_stretch = 1.3;

Row laminateRow(const std::string& element, const Discretization& discretization, double contrast) {
  BodyModel body = bodyOfTwo(cubeMesh(1, 4), discretization, contrast,
                             [](const Eigen::Vector3d& X) { return X[2] < 0.75; });
  holdSymmetryPlanes(body);
  hold(body, "xmax", "x");
  Rig rig(body);
  const NewtonResult result = rig.equilibrium(displaced(rig.system(), [](const Eigen::Vector3d& X) {
    return Eigen::Vector3d((laminate_stretch - 1) * X[0], 0, 0);
  }));
  const NodalForces forces = nodalForces(body, result.state);
  double force = 0;
  for (const std::int32_t node : nodesInPlane(body.mesh, 0, 1)) force += forces(node, 0);
  const double mean_mu = mu_of_soft * (0.75 + 0.25 * contrast);
  const double exact = mean_mu * (laminate_stretch - 1 / (laminate_stretch * laminate_stretch));
  return {fmt::format("{}, contrast {}: force", element, contrast), force, exact, 1e-8, "N"};
}

// ---- the inclusion ----------------------------------------------------------------------------

constexpr double body_radius = 2, ball_radius = 1;  ///< metres
const Eigen::Vector3d far_strain(1e-4, -0.5e-4, -0.5e-4);

/// Returns the share of the far strain that a ball does not follow, if it is `contrast` times
/// stiffer than its surroundings.
double keptOut(double contrast) { return 0.4 * (contrast - 1) / (1 + 0.4 * (contrast - 1)); }

/// Returns the displacement at X in an infinite body with a ball. The strain is uniform within the
/// ball. Outside, the displacement balances the tractions on the ball.
Eigen::Vector3d exactAround(const Eigen::Vector3d& X, double contrast) {
  const Eigen::Vector3d far = far_strain.cwiseProduct(X);
  const double c = keptOut(contrast), q = ball_radius / std::max(X.norm(), ball_radius);
  return (1 - c * std::pow(q, 5)) * far -
         2.5 * c * (std::pow(q, 3) - std::pow(q, 5)) * (X.dot(far) / X.squaredNorm()) * X;
}

/// Returns the strain of the ball along x, relative to the far strain. The outer sphere of the body
/// gets the displacement that an infinite body would have there.
double strainWithin(const Discretization& discretization, double contrast, int n) {
  BodyModel body = bodyOfTwo(ballOctantMesh(body_radius, n), discretization, contrast,
                             [](const Eigen::Vector3d& X) { return X.norm() > ball_radius; });
  holdSymmetryPlanes(body);
  hold(body, "outside", "xyz");
  // The outer sphere consists of flat triangles, so the prescribed displacement does not quite
  // preserve the volume. A large bulk modulus permits this.
  for (Material& material : body.materials) material.bulk = 1e4 * mu_of_soft;
  Rig rig(body);
  const NewtonResult result =
      rig.equilibrium(displaced(rig.system(), [&](const Eigen::Vector3d& X) {
        return X.norm() > 0 ? exactAround(X, contrast) : X;
      }));
  const std::int32_t on_axis = n / 2;  // the node where the x axis leaves the ball
  return ofNode(result.state.u, on_axis)[0] / (far_strain[0] * ball_radius);
}

Row inclusionRow(const std::string& element, const Discretization& discretization, double contrast,
                 int n) {
  return {fmt::format("ball {} times stiffer, {}, n = {}: its strain", contrast, element, n),
          strainWithin(discretization, contrast, n), 1 - keptOut(contrast), 0.01};
}

}  // namespace

std::vector<Case> interfaceCases() {
  return {{"laminate", false,
           [] {
             std::vector<Row> rows;
             for (const double contrast : {10.0, 100.0}) {
               rows.push_back(laminateRow("P2/P1", taylor_hood, contrast));
               rows.push_back(laminateRow("P1-stabilized", stabilized, contrast));
             }
             return rows;
           }},
          {"inclusion", false, [] {
             std::vector<Row> rows;
             for (const double contrast : {10.0, 100.0}) {
               rows.push_back(inclusionRow("P2/P1", taylor_hood, contrast, 4));
               rows.push_back(inclusionRow("P2/P1", taylor_hood, contrast, 8));
               rows.push_back(inclusionRow("P1-stabilized", stabilized, contrast, 16));
             }
             return rows;
           }}};
}

}  // namespace palpate::verification
