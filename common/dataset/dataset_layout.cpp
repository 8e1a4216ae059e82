#include "common/dataset/dataset_layout.hpp"

#include <algorithm>
#include <numeric>

#include "common/problem/problem.hpp"

namespace palpate::layout {

ContentId contentHash(const std::string& scene_toml, std::vector<hdf5::ArrayInfo> arrays) {
  std::sort(arrays.begin(), arrays.end(),
            [](const hdf5::ArrayInfo& a, const hdf5::ArrayInfo& b) { return a.path < b.path; });
  std::string text = fmt::format("scene_toml {}\n", ContentId::of(scene_toml).hex());
  for (const hdf5::ArrayInfo& array : arrays) {
    const std::string shape =
        array.shape.empty() ? "scalar" : fmt::format("{}", fmt::join(array.shape, "x"));
    text += fmt::format("{} {} {} {}\n", array.path, hdf5::typeOf(array.element).name, shape,
                        array.hash.hex());
  }
  return ContentId::of(text);
}

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

}  // namespace palpate::layout
