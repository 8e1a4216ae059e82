#include "tests/support/pressed_body.hpp"

#include <cmath>

#include "common/base/index.hpp"

namespace palpate::test {

PressedBody::PressedBody(const Mesh& mesh, const std::vector<Active>& active, double factor,
                         double linear_below)
    : TouchableBody(mesh, active), factor_(factor), linear_below_(linear_below) {
  problem.scene.storage.displacement = StoredNodes::all;
  if (std::isfinite(linear_below)) {
    Region below;
    below.group = "below";
    below.material = {.law = LawName::linear, .young = 1e4, .poisson = 0.4};
    problem.scene.regions.push_back(below);
  }
  for (std::size_t s = 0; s < spaces.size(); ++s)
    for (std::int32_t n = 0; n < spaces[s].lattice.size(); ++n)
      spaces[s].points[at(n)].fields = fields(s, n).id();
}

float PressedBody::pressure(std::size_t space, const Eigen::Vector3d& p,
                            std::int32_t vertex) const {
  const Eigen::Vector3d& x = problem.mesh.nodes[at(vertex)];
  if (x.z() < linear_below_) return 0;
  const double distance = (x - problem.mesh.nodes[at(problem.active[space].node)]).norm();
  return at_rest - static_cast<float>(factor_ * 1e5 * p.z() * std::exp(-distance / 0.03));
}

NodalFields PressedBody::fields(std::size_t space, std::int32_t point) const {
  NodalFields values = TouchableBody::fields(space, point);
  for (std::size_t v = 0; v < values.pressure.size(); ++v)
    values.pressure[v] =
        pressure(space, spaces[space].lattice.displacement(point), static_cast<std::int32_t>(v));
  return values;
}

void PressedBody::seal(const std::filesystem::path& file) const {
  sealDataset(file, problem, rowsOf(spaces), "portable",
              [this](std::size_t space, std::int32_t point) { return fields(space, point); });
}

}  // namespace palpate::test
