#include "viewer/c_api/loaded_dataset.hpp"

namespace palpate {
namespace {

/// Describes a space for the C API. The name in the result points into `space`. vertex: surface
/// vertex of the active node, -1 if the node lies inside the body.
palpate_space_info infoOf(const Dataset& dataset, const SpaceTable& space, std::int32_t vertex) {
  palpate_space_info info{};
  info.size = sizeof info;
  info.name = space.patch.name.c_str();
  info.node = space.patch.node;
  info.vertex = vertex;
  const auto& finger = space.patch.finger;
  give(info.rest_position,
       finger ? finger->center : dataset.mesh().nodes[static_cast<std::size_t>(space.patch.node)]);
  info.workspace_radius = space.lattice.radius();
  info.spacing = space.lattice.spacing();
  info.largest_force = largestForce(space);
  return info;
}

}  // namespace

std::mutex& hdf5Mutex() {
  static std::mutex mutex;
  return mutex;
}

LoadedDataset::LoadedDataset(const Dataset& dataset, const HapticModelOptions& options)
    : model(dataset, options), content_id(dataset.contentId().hex()) {
  info.size = sizeof info;
  info.name = model.name().c_str();
  info.file = model.file().c_str();
  info.content_id = content_id.c_str();
  info.contact_mode =
      model.contactMode() == ContactMode::glued ? PALPATE_GLUED : PALPATE_UNILATERAL;
  info.space_count = static_cast<std::int32_t>(model.spaces().size());
  info.method_count = static_cast<std::int32_t>(model.methods().size());
  info.vertex_count = static_cast<std::int32_t>(model.surface().vertices().size());
  info.triangle_count = static_cast<std::int32_t>(model.surface().triangles().size());
  info.max_force = model.maxForce();
  for (std::size_t s = 0; s < model.spaces().size(); ++s)
    spaces.push_back(infoOf(dataset, model.spaces()[s], model.surface().activeVertex(s)));
  for (const TouchArea& area : model.surface().areas()) {
    palpate_area_info& of_area = areas.emplace_back();
    of_area.size = sizeof of_area;
    of_area.name = area.name.c_str();
    of_area.finger_radius = area.radius;
    of_area.workspace_radius = model.spaces()[area.spaces.front()].lattice.radius();
    of_area.site_count = static_cast<std::int32_t>(area.spaces.size());
    places.emplace_back(dataset.mesh(), dataset.fixedNodes(),
                        centersOf(chosenOf(model.spaces(), area.spaces)), area.radius);
  }
}

}  // namespace palpate
