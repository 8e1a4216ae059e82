#include "viewer/export/configuration_grid.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "viewer/export/det_f.hpp"

namespace palpate {
namespace {

GridArray numberOf(const char* name, const char* unit, double value) {
  return {name, unit, 1, std::vector<double>{value}};
}

/// Returns a vector, or a matrix row by row.
template <class Values>
GridArray arrayOf(const char* name, const char* unit, const Values& values) {
  const auto rows = values.template reshaped<Eigen::RowMajor>();
  return {name, unit, static_cast<int>(rows.size()), std::vector<double>(rows.begin(), rows.end())};
}

std::vector<GridArray> fieldDataOf(const ExportedConfiguration& configuration) {
  const ForceSample& sample = configuration.sample;
  std::vector<GridArray> data = {arrayOf("tool_place", "m", configuration.place),
                                 arrayOf("tool_displacement", "m", configuration.displacement),
                                 arrayOf("force", "N", sample.force),
                                 arrayOf("stiffness", "N/m", sample.stiffness),
                                 numberOf("energy", "J", sample.energy),
                                 numberOf("error_bound", "N", sample.error_bound),
                                 numberOf("coverage", "1", sample.coverage)};
  data.push_back({"inside", "1", 1, std::vector<std::uint8_t>{sample.inside}});
  if (configuration.drive) data.push_back(arrayOf("drive", "N", *configuration.drive));
  if (configuration.way) data.push_back(numberOf("way", "m", *configuration.way));
  if (configuration.lattice_point)
    data.push_back(arrayOf("lattice_point", "1", *configuration.lattice_point));
  if (configuration.min_det_F) data.push_back(numberOf("min_det_F", "1", *configuration.min_det_F));
  return data;
}

}  // namespace

ConfigurationGrid::ConfigurationGrid(const Dataset& dataset) : dataset_(dataset) {
  for (const std::int32_t node : dataset.storedNodes())
    for (const double x : dataset.mesh().nodes[at(node)]) rest_.points.push_back(x);
  dataset.storedNodes().size() == dataset.mesh().nodes.size() ? addTetrahedra() : addTriangles();
  rest_.point_data.push_back({"fixed", "1", 1, marked(dataset.fixedNodes())});
}

void ConfigurationGrid::addTetrahedra() {
  const Mesh& mesh = dataset_.mesh();
  const bool is_quadratic = !mesh.mid_edge_nodes.empty();
  rest_.kind = is_quadratic ? CellKind::quadratic_tetrahedron : CellKind::tetrahedron;
  for (std::size_t element = 0; element < mesh.tetrahedra.size(); ++element) {
    const Tetrahedron& t = mesh.tetrahedra[element];
    rest_.cells.insert(rest_.cells.end(), t.begin(), t.end());
    if (!is_quadratic) continue;
    const auto& middles = mesh.mid_edge_nodes[element];
    rest_.cells.insert(rest_.cells.end(), middles.begin(), middles.end());
  }
}

void ConfigurationGrid::addTriangles() {
  const std::vector<std::int32_t>& stored = dataset_.storedNodes();
  rest_.kind = CellKind::triangle;
  for (const Triangle& triangle : dataset_.mesh().surface)
    for (const std::int32_t node : triangle) {
      const auto place = std::ranges::lower_bound(stored, node);
      PALPATE_ASSERT(place != stored.end() && *place == node,
                     "a dataset must store every vertex of its surface");
      rest_.cells.push_back(static_cast<std::int32_t>(place - stored.begin()));
    }
}

Grid ConfigurationGrid::of(const ExportedConfiguration& configuration) const {
  Grid grid = rest_;
  const NodalFields& fields = configuration.fields;
  PALPATE_ASSERT(fields.displacement.size() == grid.points.size(), "each node needs displacements");
  grid.point_data.push_back({"touched", "1", 1, marked(configuration.touched)});
  grid.point_data.push_back({"displacement", "m", 3, fields.displacement});
  if (!fields.pressure.empty())
    grid.point_data.push_back({"pressure", "Pa", 1, pressuresOf(fields)});
  if (isVolume())
    grid.cell_data.push_back({"det_F", "1", 1, detFOf(dataset_.mesh(), fields.displacement)});
  grid.field_data = fieldDataOf(configuration);
  grid.texts = {{"scene", dataset_.scene().name},
                {"active", configuration.active},
                {"method", configuration.method},
                {"content_hash", dataset_.contentId().hex()},
                {"units", "SI"}};
  return grid;
}

std::vector<std::uint8_t> ConfigurationGrid::marked(const std::vector<std::int32_t>& nodes) const {
  return mapped(dataset_.storedNodes(), [&](std::int32_t node) {
    return static_cast<std::uint8_t>(std::ranges::binary_search(nodes, node));
  });
}

std::vector<float> ConfigurationGrid::pressuresOf(const NodalFields& fields) const {
  const Mesh& mesh = dataset_.mesh();
  std::vector<float> pressures = fields.pressure;
  if (pressures.size() == mesh.nodes.size()) return pressures;
  PALPATE_ASSERT(pressures.size() == at(mesh.vertices()), "pressures must be of vertices or nodes");
  for (const auto& [a, b] : mesh.edges)
    pressures.push_back(0.5F * (pressures[at(a)] + pressures[at(b)]));
  return pressures;
}

}  // namespace palpate
