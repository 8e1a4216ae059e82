#include "viewer/c_api/loaded_dataset.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
#include "viewer/c_api/arguments.hpp"

namespace palpate {
namespace {

double largestForce(const SpaceTable& space) {
  double largest = 0;
  for (const PointRecord& point : space.points)
    if (isSolved(point.tag)) largest = std::max(largest, point.equilibrium.force.norm());
  return largest;
}

/// Its name is that of `space`; `vertex` is its active node's, -1 when that lies inside the body.
palpate_space_info infoOf(const Dataset& dataset, const SpaceTable& space, std::int32_t vertex) {
  palpate_space_info info{};
  info.size = sizeof info;
  info.name = space.patch.name.c_str();
  info.node = space.patch.node;
  info.vertex = vertex;
  give(info.rest_position, dataset.mesh().nodes[static_cast<std::size_t>(space.patch.node)]);
  info.workspace_radius = space.lattice.radius();
  info.spacing = space.lattice.spacing();
  info.largest_force = largestForce(space);
  return info;
}

}  // namespace

LoadedDataset::LoadedDataset(const Dataset& dataset, const HapticModelOptions& options)
    : model_(dataset, options), content_id_(dataset.contentId().hex()) {
  info_ = {};
  info_.size = sizeof info_;
  info_.name = model_.name().c_str();
  info_.file = model_.file().c_str();
  info_.content_id = content_id_.c_str();
  info_.contact_mode =
      model_.contactMode() == ContactMode::glued ? PALPATE_GLUED : PALPATE_UNILATERAL;
  info_.space_count = static_cast<std::int32_t>(model_.spaces().size());
  info_.method_count = static_cast<std::int32_t>(model_.methods().size());
  info_.vertex_count = static_cast<std::int32_t>(model_.surface().vertices().size());
  info_.triangle_count = static_cast<std::int32_t>(model_.surface().triangles().size());
  info_.max_force = model_.maxForce();
  PALPATE_ASSERT(model_.spaces().size() == dataset.spaces().size(),
                 "the numbers of spaces are those of the dataset");
  for (std::size_t s = 0; s < model_.spaces().size(); ++s)
    spaces_.push_back(infoOf(dataset, model_.spaces()[s], model_.surface().activeVertex(s)));
}

}  // namespace palpate
