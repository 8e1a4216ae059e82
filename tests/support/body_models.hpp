#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/meshes.hpp"
#include "worker/solver/body_model.hpp"

/// Bodies made in code for tests of discretisation and solvers, without a scene.
namespace palpate::test {

struct NamedMaterial {
  std::string name;
  Material material;
};

/// One material for every law, as soft as tissue (a few kPa). Incompressible ones have no `bulk`.
inline std::vector<NamedMaterial> everyMaterial() {
  std::vector<NamedMaterial> all;
  for (const Material& material : std::vector<Material>{
           {.law = LawName::linear, .young = 15480, .poisson = 0.45},
           {.law = LawName::st_venant_kirchhoff, .young = 15480, .poisson = 0.45},
           {.law = LawName::modified_st_venant_kirchhoff, .young = 15480, .poisson = 0.45},
           {.law = LawName::mooney_rivlin, .c10 = 1300, .c01 = 1280},
           {.law = LawName::neo_hookean, .mu = 5000},
           {.law = LawName::yeoh, .c10 = 1500, .c20 = 400, .c30 = 900},
           {.law = LawName::ogden, .ogden = {{6300 / 2.0, 1.3}, {120, 5.0}, {-1000 / 2.0, -2.0}}},
           {.law = LawName::veronda_westmann, .c1 = 3500, .c2 = 1.5},
           {.law = LawName::holzapfel_gasser_ogden,
           .mu = 3000,
           .k1 = 2000,
           .k2 = 1.2,
           .dispersion = 0.1,
           .fibers = {Eigen::Vector3d(1, 0.5, 0).normalized(), Eigen::Vector3d(0, 0.6, 0.8)}}})
    all.push_back({std::string(word(material.law)), material});
  return all;
}

inline Material materialOf(LawName law) {
  for (const NamedMaterial& named : everyMaterial())
    if (named.material.law == law) return named.material;
  return {};
}

/// Every pair of displacement and pressure spaces.
inline std::vector<Discretization> everyElement() {
  using enum PressureSpace;
  std::vector<Discretization> all;
  for (const PressureSpace pressure : {none, p1, p1_stabilized})
    all.push_back({DisplacementSpace::p1, pressure, Constraint::ln_det_F});
  for (const PressureSpace pressure : {none, p1, p2})
    all.push_back({DisplacementSpace::p2, pressure, Constraint::ln_det_F});
  return all;
}

inline std::string nameOf(const Discretization& discretization) {
  return std::string(word(discretization.displacement)) + "/" +
         std::string(word(discretization.pressure));
}

/// A body of `mesh` and one material without fixed nodes, loads or tools. Adds mid-edge nodes if
/// needed, and a bulk modulus if no pressure enforces incompressibility. All tetrahedra have the
/// fibres of the material.
inline BodyModel freeBody(Mesh mesh, const Discretization& discretization, Material material) {
  if (discretization.displacement == DisplacementSpace::p2) addMidEdgeNodes(mesh);
  if (discretization.pressure == PressureSpace::none && isIncompressible(material))
    material.bulk = 40000;
  BodyModel model;
  model.mesh = std::move(mesh);
  model.discretization = discretization;
  model.region_of.assign(model.mesh.tetrahedra.size(), 0);
  if (!material.fibers.empty())
    model.fibers.assign(model.mesh.tetrahedra.size(),
                        {material.fibers.front(), material.fibers.back()});
  model.materials = {std::move(material)};
  model.fixed.assign(3 * model.mesh.nodes.size(), 0);
  return model;
}

/// Fixes these components (x, y, z) at the nodes of a group.
inline void fix(BodyModel& model, const std::string& group,
                const std::vector<int>& components = {0, 1, 2}) {
  for (const std::int32_t node : model.mesh.node_groups.at(group))
    for (const int i : components) model.fixed[3 * static_cast<std::size_t>(node) + i] = 1;
}

/// The nodes of a group as a tool, rigid or with equal weights.
inline Tool toolOf(const BodyModel& model, const std::string& group, bool weighted = false) {
  Tool tool{model.mesh.node_groups.at(group), {}};
  if (weighted)
    tool.weights.assign(tool.nodes.size(), 1.0 / static_cast<double>(tool.nodes.size()));
  return tool;
}

/// The surface triangles whose vertices are all in a group.
inline std::vector<Triangle> facesOf(const Mesh& mesh, const std::string& group) {
  const std::vector<std::int32_t>& nodes = mesh.node_groups.at(group);
  std::vector<Triangle> faces;
  for (const Triangle& face : mesh.surface)
    if (std::all_of(face.begin(), face.end(), [&](std::int32_t node) {
          return std::binary_search(nodes.begin(), nodes.end(), node);
        }))
      faces.push_back(face);
  return faces;
}

}  // namespace palpate::test
