#include <nlohmann/json.hpp>

#include "common/base/assertion.hpp"
#include "worker/check/scene_report.hpp"

namespace palpate {
namespace {

nlohmann::ordered_json vectorJson(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

nlohmann::ordered_json meshJson(const SceneReport& report) {
  const Mesh& mesh = report.problem->mesh;
  const MeshQuality& quality = report.quality;
  nlohmann::ordered_json groups = nlohmann::ordered_json::object();  // {} instead of null
  for (const auto& [name, nodes] : mesh.node_groups) groups[name] = nodes.size();
  return {{"file", report.problem->scene.mesh.string()},
          {"nodes", mesh.vertices()},
          {"mid_edge_nodes", mesh.edges.size()},
          {"tetrahedra", mesh.tetrahedra.size()},
          {"surface_triangles", mesh.surface.size()},
          {"surface_nodes", surfaceNodes(mesh).size()},
          {"pieces", quality.pieces},
          {"coincident_nodes", quality.coincident.size()},
          {"hinge_nodes", quality.hinges.size()},
          {"groups", groups},
          {"dropped_nodes", mesh.dropped_nodes},
          {"reoriented_tetrahedra", mesh.reoriented_tetrahedra},
          {"lowest", vectorJson(quality.lowest)},
          {"highest", vectorJson(quality.highest)},
          {"volume", quality.volume},
          {"edge",
           {{"shortest", quality.shortest_edge},
            {"mean", quality.mean_edge},
            {"longest", quality.longest_edge}}},
          {"shape",
           {{"worst", quality.worst_shape},
            {"mean", quality.mean_shape},
            {"worst_element", quality.worst_element}}},
          {"nearly_flat", report.quality.nearly_flat}};
}

nlohmann::ordered_json deviceJson(const Scene& scene) {
  if (!scene.device) return nullptr;
  const Device& device = *scene.device;
  const auto orNull = [](const std::optional<double>& value) {
    return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
  };
  return {{"profile", device.profile.name},
          {"max_force", device.profile.max_force},
          {"max_stiffness", device.profile.max_stiffness},
          {"workspace_radius", device.profile.workspace_radius},
          {"radius_cut_from", orNull(device.wanted_radius)},
          {"max_force_cut_from", orNull(device.wanted_max_force)}};
}

}  // namespace

std::string sceneReportJson(const SceneReport& report) {
  const Scene& scene = report.problem->scene;
  nlohmann::ordered_json active = nlohmann::ordered_json::array();
  for (const SceneReport::Space& space : report.spaces)
    active.push_back({{"name", space.patch->name},
                      {"node", space.patch->node},
                      {"position", vectorJson(space.place)},
                      {"tool", space.tool},
                      {"patch_nodes", space.patch->nodes.size()},
                      {"unknowns", space.unknowns}});
  PALPATE_ASSERT(report.tetrahedra_in.size() == scene.regions.size(), "each region needs a count");
  nlohmann::ordered_json regions = nlohmann::ordered_json::array();
  for (std::size_t r = 0; r < scene.regions.size(); ++r) {
    const Material& material = scene.regions[r].material;
    // JSON has no infinity, so the bulk modulus of an incompressible material is null.
    regions.push_back({{"group", scene.regions[r].name()},
                       {"law", word(material.law)},
                       {"tetrahedra", report.tetrahedra_in[r]},
                       {"young", youngModulus(material)},
                       {"poisson", poissonRatio(material)},
                       {"shear", shearModulus(material)},
                       {"bulk", bulkModulus(material)},
                       {"volume", report.volume_of[r]}});
    if (material.density) regions.back()["mass"] = *material.density * report.volume_of[r];
  }
  const Estimate &least = report.cost.least, &likely = report.cost.likely;
  return nlohmann::ordered_json{{"scene", scene.name},
                                {"problem", problemId(*report.problem).hex()},
                                {"metres_per_unit", scene.metres_per_unit},
                                {"mesh", meshJson(report)},
                                {"regions", regions},
                                {"gravity", vectorJson(scene.gravity)},
                                {"displacement", word(scene.discretization.displacement)},
                                {"pressure", word(scene.discretization.pressure)},
                                {"constraint", word(scene.discretization.constraint)},
                                {"fixed_nodes", report.problem->fixed.size()},
                                {"active", active},
                                {"lattice",
                                 {{"radius", report.lattice.radius()},
                                  {"spacing", report.lattice.spacing()},
                                  {"points", report.lattice.size()}}},
                                {"device", deviceJson(scene)},
                                {"adaptive", scene.accuracy.adaptive()},
                                {"configurations", least.configurations},
                                {"core_seconds", least.seconds},
                                {"dataset_bytes", least.bytes},
                                {"likely_configurations", likely.configurations},
                                {"likely_core_seconds", likely.seconds},
                                {"likely_dataset_bytes", likely.bytes},
                                {"measured",
                                 {{"transitions", report.measured.transitions},
                                  {"ways", report.measured.paths.size()},
                                  {"seconds", report.measured.seconds},
                                  {"reached", report.cost.reached},
                                  {"arithmetic", report.arithmetic}}},
                                {"warnings", report.warnings}}
      .dump();
}

}  // namespace palpate
