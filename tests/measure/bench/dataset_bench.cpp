// Time to seal and open a dataset: one with hundreds of small spaces, as for a whole surface, and
// one with ten large spaces that store all nodes. The configurations are made up. Prints one JSON
// object. Checks nothing, because times depend on the machine.
//
//   palpate_dataset_bench

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "common/dataset/dataset.hpp"
#include "common/mesh/node_set.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/problems.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A cube of `cells`^3 cells whose first `n_spaces` movable surface nodes are active.
Problem cubeProblem(int cells, std::size_t n_spaces, double spacing, const Storage& storage) {
  Scene scene = test::mooneyRivlinScene();
  scene.fixed.groups = {"xmin"};
  scene.workspace.spacing = spacing;
  scene.storage = storage;
  Mesh mesh = test::cubeMesh(0.2, cells);
  const NodeSet fixed = mesh.node_groups.at("xmin");
  for (const std::int32_t node : surfaceNodes(mesh))
    if (!contains(fixed, node) && scene.active.size() < n_spaces)
      scene.active.push_back({.name = fmt::format("skin-{}", node), .node = node});
  return resolve(std::move(scene), std::move(mesh));
}

/// A dent around the active node, detailed enough not to compress to nothing.
NodalFields dent(const Problem& problem, std::size_t space, const Eigen::Vector3d& displacement) {
  NodalFields fields;
  const Eigen::Vector3d at = problem.mesh.nodes[problem.active[space].node];
  for (const Eigen::Vector3d& x : problem.mesh.nodes) {
    const double weight = std::exp(-(x - at).squaredNorm() / 2e-3) * x.x() / 0.2;
    for (int i = 0; i < 3; ++i) {
      const double detail = 1e-3 * std::sin(1e3 * x[(i + 1) % 3]) * displacement[(i + 2) % 3];
      fields.displacement.push_back(static_cast<float>(weight * (displacement[i] + detail)));
    }
  }
  fields.pressure.assign(problem.pressures.count(), 1.0f);
  return fields;
}

std::string measured(const char* name, const Problem& problem) {
  const test::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "bench.h5";
  const Lattice lattice = uniformLattice(problem.scene);
  const FieldsSource fields = [&](std::size_t space, std::int32_t point) {
    return dent(problem, space, lattice.displacement(point));
  };
  std::vector<SpaceTable> spaces;
  for (std::size_t s = 0; s < problem.active.size(); ++s) {
    spaces.push_back(test::solvedSpace(lattice, test::StiffeningEnergy()));
    spaces[s].patch = problem.active[s];
    for (std::int32_t n = 0; n < lattice.size(); ++n)
      spaces[s].points[n].fields = fields(s, n).id();
  }
  Clock::time_point start = Clock::now();
  sealDataset(file, problem, rowsOf(spaces), "portable", fields);
  const double sealing = secondsSince(start);
  start = Clock::now();
  const Dataset dataset(file);
  const double opening = secondsSince(start);
  start = Clock::now();
  const std::size_t n_values = dataset.surfaceFields(0).displacement.size();
  return fmt::format(
      "\"{}\":{{\"spaces\":{},\"points_each\":{},\"stored_nodes\":{},\"megabytes\":{:.1f},\"seal_seconds\":{:.2f},\"open_seconds\":{:.4f},\"surface_of_one_space_seconds\":{:.4f},\"surface_values\":{}}}",
      name, spaces.size(), lattice.size(), dataset.storedNodes().size(),
      static_cast<double>(std::filesystem::file_size(file)) / 1e6, sealing, opening,
      secondsSince(start), n_values);
}

}  // namespace
}  // namespace palpate

int main() {
  using namespace palpate;
  const Storage all = {StoredNodes::all, StoredPrecision::float32},
                small = {StoredNodes::all, StoredPrecision::int16};
  fmt::print("{{{},{},{},{}}}\n", measured("many_spaces", cubeProblem(9, 400, 0.0407, {})),
             measured("large_spaces", cubeProblem(12, 10, 0.02, all)),
             measured("large_spaces_surface", cubeProblem(12, 10, 0.02, {})),
             measured("large_spaces_int16", cubeProblem(12, 10, 0.02, small)));
}
