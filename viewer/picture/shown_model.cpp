#include "viewer/picture/shown_model.hpp"

#include <algorithm>

#include "viewer/plot/round_numbers.hpp"

namespace palpate {
namespace {

constexpr double ghost_share = 0.01;  // of the sphere's radius: shorter displacements have no ghost

FramedSphere sphereAround(const std::vector<Eigen::Vector3d>& vertices) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : vertices) box.extend(vertex);
  FramedSphere sphere{box.center(), 0};
  for (const Eigen::Vector3d& vertex : vertices)
    sphere.radius = std::max(sphere.radius, (vertex - sphere.centre).norm());
  return sphere;
}

std::vector<bool> touchableTriangles(const TouchSurface& surface) {
  std::vector<bool> touchable(surface.triangles().size());
  for (std::size_t t = 0; t < touchable.size(); ++t)
    touchable[t] = surface.touchable(static_cast<std::int32_t>(t));
  return touchable;
}

}  // namespace

ShownModel::ShownModel(const HapticModel& model)
    : model_(model),
      sphere_(sphereAround(model.surface().vertices())),
      body_(SurfaceShape(model.surface().vertices(), model.surface().triangles(),
                         touchableTriangles(model.surface()))),
      deformed_(model.surface().vertices().size()),
      displacements_(3 * model.surface().vertices().size()) {
  body_.setGhostFrom(ghost_share * sphere_.radius);
}

Eigen::Vector3d ShownModel::bestView() const {
  const TouchSurface& surface = model_.surface();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
    if (!surface.touchable(static_cast<std::int32_t>(t))) continue;
    const Triangle& corners = surface.triangles()[t];
    const auto vertex = [&](std::size_t n) -> const Eigen::Vector3d& {
      return surface.vertices()[static_cast<std::size_t>(corners[n])];
    };
    normal += (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0));
  }
  if (normal.norm() > 0) normal.normalize();
  // From the side of the normal: an arrow toward the eye would be a dot.
  const Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(normal);
  return 0.8 * normal + 0.75 * right + 0.35 * Eigen::Vector3d::UnitY() +
         0.25 * Eigen::Vector3d::UnitZ();
}

Eigen::Vector3d ShownModel::originOf(std::size_t space) const {
  const std::int32_t vertex = model_.surface().activeVertex(space);
  return vertex < 0 ? sphere_.centre
                    : model_.surface().vertices()[static_cast<std::size_t>(vertex)];
}

void ShownModel::deform(const Touch& touch) { deformed_.evaluate(model_, touch, displacements_); }

void ShownModel::shade() {
  SurfaceShape& shape = body_.shape();
  shape.setDisplacements(displacements_);
  if (shape.largest() > full_colour_) full_colour_ = roundUp(shape.largest());
  shape.setColours(full_colour_);
}

}  // namespace palpate
