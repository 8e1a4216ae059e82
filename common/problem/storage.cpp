#include "common/problem/storage.hpp"

#include <numeric>

#include "common/problem/problem.hpp"

namespace palpate {

std::vector<std::int32_t> storedNodes(const Scene& scene, const Mesh& mesh) {
  if (scene.storage.displacement == StoredNodes::surface) return surfaceNodes(mesh);
  std::vector<std::int32_t> nodes(mesh.nodes.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  return nodes;
}

std::size_t storedPressures(const Scene& scene, const Mesh& mesh) {
  if (scene.storage.displacement == StoredNodes::surface) return 0;
  return pressureNodes(scene.discretization.pressure, mesh);
}

std::size_t storedBytes(const Scene& scene, const Mesh& mesh) {
  const bool integers = scene.storage.precision == StoredPrecision::int16;
  const std::size_t component = integers ? sizeof(std::int16_t) : sizeof(float);
  return 3 * component * storedNodes(scene, mesh).size() +
         sizeof(float) * storedPressures(scene, mesh);
}

}  // namespace palpate
