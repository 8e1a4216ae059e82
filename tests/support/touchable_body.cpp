#include "tests/support/touchable_body.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/support/symmetric_slope.hpp"

namespace palpate::test {
namespace {

constexpr double hardening = 1.5e5;  // N/m^3

Eigen::Matrix3d softness() {
  Eigen::Matrix3d a;
  a << 60, 5, 2, 5, 45, 4, 2, 4, 70;
  return a;
}

}  // namespace

ConvexEnergy::ConvexEnergy(double factor, const Eigen::Vector3d& stiff_along)
    : factor_(factor), at_rest_(softness() + stiff_along * stiff_along.transpose()) {}

double ConvexEnergy::energy(const Eigen::Vector3d& p) const {
  return factor_ * (p.dot(at_rest_ * p) / 2 + hardening / 4 * p.squaredNorm() * p.squaredNorm());
}

Eigen::Vector3d ConvexEnergy::gradient(const Eigen::Vector3d& p) const {
  return factor_ * (at_rest_ * p + hardening * p.squaredNorm() * p);
}

Eigen::Matrix3d ConvexEnergy::hessian(const Eigen::Vector3d& p) const {
  return factor_ * (at_rest_ + hardening * (p.squaredNorm() * Eigen::Matrix3d::Identity() +
                                            2 * p * p.transpose()));
}

SymmetricSlope ConvexEnergy::hessianSlope(const Eigen::Vector3d& p) const {
  SymmetricSlope slope = 2 * slopeOf(Eigen::Matrix3d::Identity(), p);
  for (std::size_t c = 0; c < symmetric_axes.size(); ++c) {
    const auto [a, b] = symmetric_axes[c];
    slope(static_cast<Eigen::Index>(c), a) += 2 * p[b];
    slope(static_cast<Eigen::Index>(c), b) += 2 * p[a];
  }
  return factor_ * hardening * slope;
}

TouchableBody::TouchableBody(Mesh mesh, const std::vector<Active>& active, double radius,
                             double spacing) {
  problem.mesh = std::move(mesh);
  problem.fixed = problem.mesh.node_groups.at("zmin");
  Scene& scene = problem.scene;
  scene.name = "touchable";
  scene.mesh = "touchable.msh";
  scene.regions[0].material = {.law = LawName::mooney_rivlin, .c10 = 1300, .c01 = 1280};
  scene.fixed.nodes = problem.fixed;
  problem.region_of.assign(problem.mesh.tetrahedra.size(), 0);
  problem.pressures = pressureSlots(problem);
  scene.workspace = {
      .radius = radius, .spacing = spacing, .max_force = 8.5, .reject_inverted = true};
  for (const Active& one : active) {
    ActiveSelection selection;
    selection.name = "node-" + std::to_string(one.node);
    selection.node = one.node;
    scene.active.push_back(selection);
    problem.active.push_back({selection.name, one.node, {one.node}});
  }
  const Lattice lattice(radius, spacing);
  for (std::size_t s = 0; s < active.size(); ++s) {
    spaces.push_back(solvedSpace(lattice, ConvexEnergy(active[s].factor, active[s].stiff_along)));
    spaces[s].patch = problem.active[s];
    for (std::int32_t n = 0; n < lattice.size(); ++n)
      spaces[s].points[static_cast<std::size_t>(n)].fields = fields(s, n).id();
  }
}

NodalFields movedAround(const Problem& problem, const Eigen::Vector3d& center,
                        const Eigen::Vector3d& p) {
  NodalFields values;
  for (const Eigen::Vector3d& node : problem.mesh.nodes)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      values.displacement.push_back(
          static_cast<float>(p[axis] * std::exp(-(node - center).norm() / 0.03)));
  values.pressure.assign(problem.pressures.count(), 0.0f);
  return values;
}

NodalFields TouchableBody::fields(std::size_t space, std::int32_t point) const {
  const auto node = static_cast<std::size_t>(problem.active[space].node);
  return movedAround(problem, problem.mesh.nodes[node], spaces[space].lattice.displacement(point));
}

void TouchableBody::seal(const std::filesystem::path& file) const {
  sealDataset(file, problem, rowsOf(spaces), "portable",
              [this](std::size_t space, std::int32_t point) { return fields(space, point); });
}

std::vector<TouchableBody::Active> wholeSurface(
    const Mesh& mesh, const std::function<double(const Eigen::Vector3d&)>& factor) {
  const std::vector<std::int32_t>& fixed = mesh.node_groups.at("zmin");
  std::vector<TouchableBody::Active> active;
  for (const std::int32_t node : surfaceNodes(mesh))
    if (!std::ranges::binary_search(fixed, node))
      active.push_back({node, factor(mesh.nodes[static_cast<std::size_t>(node)])});
  return active;
}

}  // namespace palpate::test
