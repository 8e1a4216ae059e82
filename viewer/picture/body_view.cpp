#include "viewer/picture/body_view.hpp"

#include <algorithm>
#include <array>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "viewer/plot/round_numbers.hpp"
#include "viewer/plot/widest_view.hpp"

namespace palpate {
namespace {

using Colour = std::array<float, 4>;
constexpr Colour ambient = {0.42F, 0.42F, 0.44F, 1}, gloss = {0.16F, 0.16F, 0.16F, 1};
constexpr Colour rim_colour = {0.16F, 0.18F, 0.24F, 1};
constexpr Colour ghost_lines = {0.12F, 0.22F, 0.42F, 0.40F},
                 ghost_fill = {0.45F, 0.62F, 0.90F, 0.16F};

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

void drawElements(GLenum kind, std::span<const std::uint32_t> indices) {
  glDrawElements(kind, static_cast<GLsizei>(indices.size()), GL_UNSIGNED_INT, indices.data());
}

}  // namespace

BodyView::BodyView(const HapticModel& model)
    : model_(model),
      sphere_(sphereAround(model.surface().vertices())),
      shape_(model.surface().vertices(), model.surface().triangles(),
             touchableTriangles(model.surface())),
      deformed_(shape_.size()),
      displacements_(3 * shape_.size()),
      drawing_([this] { draw(); }) {
  ghost_edges_.reserve(shape_.edges().size());
  ghost_corners_.reserve(shape_.corners().size());
}

Eigen::Vector3d BodyView::bestView() const {
  const TouchSurface& surface = model_.surface();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double area = 0;
  for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
    if (!surface.touchable(static_cast<std::int32_t>(t))) continue;
    const Triangle& corners = surface.triangles()[t];
    const auto vertex = [&](std::size_t n) -> const Eigen::Vector3d& {
      return surface.vertices()[at(corners[n])];
    };
    const Eigen::Vector3d doubled = (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0));
    normal += doubled;
    area += doubled.norm();
  }
  // Touched all around: from where the body looks widest, a little from above.
  constexpr double least_lean = 0.2;
  if (normal.norm() < least_lean * area)
    return widestView(surface.vertices()) + 0.45 * Eigen::Vector3d::UnitZ();
  normal.normalize();
  // From the side of the normal: an arrow toward the eye would be a dot.
  const Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(normal);
  return 0.8 * normal + 0.75 * right + 0.35 * Eigen::Vector3d::UnitY() +
         0.25 * Eigen::Vector3d::UnitZ();
}

Eigen::Vector3d BodyView::originOf(std::size_t space) const {
  const std::int32_t vertex = model_.surface().activeVertex(space);
  return vertex < 0 ? sphere_.centre : model_.surface().vertices()[at(vertex)];
}

void BodyView::deform(const Touch& touch) {
  PALPATE_ASSERT(!touch.touching || at(touch.anchor.triangle) < model_.surface().triangles().size(),
                 "the touch is of this model");
  deformed_.evaluate(model_, touch, displacements_);
}

void BodyView::shade() {
  shape_.setDisplacements(displacements_);
  if (shape_.largest() > full_colour_) full_colour_ = roundUp(shape_.largest());
  shape_.setColours(full_colour_);
}

void BodyView::draw() {
  glEnable(GL_DEPTH_TEST);
  glEnableClientState(GL_VERTEX_ARRAY);
  drawSurface();
  drawRim();
  if (ghost_) drawGhost();
}

void BodyView::drawSurface() const {
  glEnable(GL_LIGHTING);
  glShadeModel(GL_SMOOTH);
  glLightModelfv(GL_LIGHT_MODEL_AMBIENT, ambient.data());
  glLightModeli(GL_LIGHT_MODEL_TWO_SIDE, GL_FALSE);
  glColorMaterial(GL_FRONT_AND_BACK, GL_AMBIENT_AND_DIFFUSE);
  glEnable(GL_COLOR_MATERIAL);
  glMaterialfv(GL_FRONT_AND_BACK, GL_SPECULAR, gloss.data());
  glMaterialf(GL_FRONT_AND_BACK, GL_SHININESS, 24);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  // Behind the lines that lie on it.
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1, 2);
  glEnableClientState(GL_NORMAL_ARRAY);
  glEnableClientState(GL_COLOR_ARRAY);
  glVertexPointer(3, GL_FLOAT, 0, shape_.positions().data());
  glNormalPointer(GL_FLOAT, 0, shape_.normals().data());
  glColorPointer(4, GL_UNSIGNED_BYTE, 0, shape_.colours().data());
  drawElements(GL_TRIANGLES, shape_.corners());
  glDisableClientState(GL_NORMAL_ARRAY);
  glDisableClientState(GL_COLOR_ARRAY);
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDisable(GL_LIGHTING);
}

void BodyView::drawRim() const {
  glLineWidth(2);
  glColor4fv(rim_colour.data());
  glVertexPointer(3, GL_FLOAT, 0, shape_.positions().data());
  drawElements(GL_LINES, shape_.rim());
  glLineWidth(1);
}

void BodyView::drawGhost() {
  const double least = ghost_share * sphere_.radius;
  const auto moved = [&](std::uint32_t vertex) { return shape_.length(vertex) > least; };
  ghost_edges_.clear();
  for (std::size_t n = 0; n < shape_.edges().size(); n += 2)
    if (moved(shape_.edges()[n]) || moved(shape_.edges()[n + 1]))
      ghost_edges_.insert(ghost_edges_.end(), {shape_.edges()[n], shape_.edges()[n + 1]});
  ghost_corners_.clear();
  for (std::size_t n = 0; n < shape_.corners().size(); n += 3) {
    const std::span<const std::uint32_t> triangle = shape_.corners().subspan(n, 3);
    if (std::any_of(triangle.begin(), triangle.end(), moved))
      ghost_corners_.insert(ghost_corners_.end(), triangle.begin(), triangle.end());
  }
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  // What is translucent hides nothing that is drawn after it.
  glDepthMask(GL_FALSE);
  glVertexPointer(3, GL_FLOAT, 0, shape_.rest().data());
  glColor4fv(ghost_fill.data());
  drawElements(GL_TRIANGLES, ghost_corners_);
  glColor4fv(ghost_lines.data());
  drawElements(GL_LINES, ghost_edges_);
}

}  // namespace palpate
