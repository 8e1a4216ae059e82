#include "viewer/picture/body_view.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "viewer/haptics/blended_force.hpp"
#include "viewer/picture/lattice_dots.hpp"
#include "viewer/picture/open_gl.hpp"
#include "viewer/plot/round_numbers.hpp"
#include "viewer/plot/widest_view.hpp"

namespace palpate {
namespace {

/// Smallest end of the displacement scale, before rounding, in radii of the sphere.
constexpr double first_scale_share = 0.035;

constexpr float contour_width = 1.7F, contour_opacity = 0.85F;
constexpr std::array<std::uint8_t, 3> ghost_line = {36, 61, 117}, ghost_fill = {92, 128, 196};
constexpr float ghost_line_opacity = 0.75F, ghost_line_width = 1.6F;
constexpr float ghost_fill_opacity = 0.22F;
// The ghost fades in between these two displacements, in radii of the sphere: it is invisible below
// the first and complete above the second.
constexpr double ghost_begins = 0.008, ghost_whole = 0.03;

// Pressure scales. least_scale_share: smallest end, as a fraction of the usual pressure.
// scale_of_nothing: usual pressure to assume if all pressures are zero, Pa.
constexpr double least_scale_share = 0.1, scale_of_nothing = 1000;

std::vector<bool> touchableTriangles(const TouchSurface& surface) {
  return mapped(countUp(surface.triangles().size()),
                [&](std::int32_t triangle) { return surface.touchable(triangle); });
}

void drawElements(GLenum kind, std::span<const std::uint32_t> vertices) {
  glDrawElements(kind, static_cast<GLsizei>(vertices.size()), GL_UNSIGNED_INT, vertices.data());
}

// Stencil bits. body_mark: pixels of the body, where the ghost is hidden. fill_mark: pixels that
// the fill of the ghost has covered, so that each is blended only once.
constexpr GLuint body_mark = 1, fill_mark = 2;

/// Prepares OpenGL to draw the front faces of vertex arrays with colours.
void beginSurfaces() {
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  glEnableClientState(GL_VERTEX_ARRAY);
  glEnableClientState(GL_COLOR_ARRAY);
}

/// Returns the position of the eye, in the frame of the drawn object.
Eigen::Vector3f eyeOfView() {
  Eigen::Matrix4d view;
  glGetDoublev(GL_MODELVIEW_MATRIX, view.data());
  return (-view.topLeftCorner<3, 3>().transpose() * view.topRightCorner<3, 1>()).cast<float>();
}

constexpr double half_way = 0.5;  // depth of the press, in radii of the workspace

/// Returns the vertex as a point of a touchable triangle; nullopt if it belongs to no touchable
/// triangle.
std::optional<SurfacePoint> touchablePoint(const TouchSurface& surface, std::int32_t vertex) {
  for (const std::int32_t triangle : surface.trianglesAt(vertex)) {
    if (!surface.touchable(triangle)) continue;
    const auto& [a, b, c] = surface.triangles()[at(triangle)];
    return SurfacePoint{triangle, Eigen::Vector3d(a == vertex, b == vertex, c == vertex)};
  }
  return std::nullopt;
}

/// Returns the workspace radius of the space with the largest weight at a vertex, m.
double radiusAt(const HapticModel& model, std::int32_t vertex) {
  const std::span<const SpaceWeight> shares = model.surface().sharesOf(vertex);
  const auto most = std::ranges::max_element(shares, {}, &SpaceWeight::weight);
  return most == shares.end() ? 0 : model.spaces()[at(most->space)].lattice.radius();
}

}  // namespace

BodyView::BodyView(const HapticModel& model)
    : model_(model),
      sphere_(sphereAround(model.surface().vertices())),
      shape_(model.surface().vertices(), model.surface().triangles(),
             touchableTriangles(model.surface())),
      contour_(shape_.corners()),
      deformed_(model.surface().vertices().size()),
      displacements_(3 * model.surface().vertices().size()) {
  forgetScale();
  ghost_shares_.resize(shape_.size());
  ghost_colours_.resize(shape_.size());
  ghost_corners_.reserve(shape_.corners().size());
  has_untouchable_ = std::ranges::count(touchableTriangles(model.surface()), false) > 0;
}

void BodyView::forgetScale() {
  full_colour_ = roundUp(first_scale_share * sphere_.radius);
  full_pressure_ = 0;
}

Eigen::Vector3d BodyView::bestView() const {
  const TouchSurface& surface = model_.surface();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double area = 0;
  for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
    if (!surface.touchable(static_cast<std::int32_t>(t))) continue;
    const auto [a, b, c] = cornersOf(surface.vertices(), surface.triangles()[t]);
    const Eigen::Vector3d doubled = (b - a).cross(c - a);
    normal += doubled;
    area += doubled.norm();
  }
  // The body is touchable all around. Look from the side where it looks widest, slightly from
  // above.
  constexpr double least_lean = 0.2;
  if (normal.norm() < least_lean * area)
    return widestView(surface.vertices()) + 0.45 * Eigen::Vector3d::UnitZ();
  normal.normalize();
  // Turn the view away from the normal, because an arrow toward the eye would look like a dot.
  const Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(normal);
  return 0.8 * normal + 0.75 * right + 0.35 * Eigen::Vector3d::UnitY() +
         0.25 * Eigen::Vector3d::UnitZ();
}

Eigen::Vector3d BodyView::originOf(std::size_t space) const {
  const std::int32_t vertex = model_.surface().activeVertex(space);
  return vertex < 0 ? sphere_.centre : model_.surface().vertices()[at(vertex)];
}

void BodyView::deform(const Touch& touch, const std::optional<Touch>& held) {
  PALPATE_ASSERT(!touch.touching || at(touch.anchor.triangle) < model_.surface().triangles().size(),
                 "the touched triangle must belong to this model");
  const std::array<Touch, 2> touches = {held.value_or(Touch()), touch};
  deformed_.evaluate(model_, touches, displacements_);
  blend_ = touch.touching ? touch.blend : SpaceBlend();
  touch_displacement_ = touch.displacement - touch.excess();
}

void BodyView::shade(SurfaceColour colour, std::int32_t method) {
  shape_.setDisplacements(displacements_);
  // After a release the scale begins again, so that it does not depend on earlier presses.
  if (shape_.largest() <= 0) forgetScale();
  if (shape_.largest() > full_colour_) full_colour_ = roundUp(shape_.largest());
  switch (colour) {
    case SurfaceColour::tissue: shape_.colourTissue(); break;
    case SurfaceColour::displacement: shape_.colourDisplacements(full_colour_); break;
    case SurfaceColour::error: shape_.colourPlaces(errorPlacesOf(method)); break;
    case SurfaceColour::pressure: colourPressures(); break;
  }
}

void BodyView::colourPressures() {
  const SurfacePressures& known = model_.pressures();
  if (!known.isPrepared()) return shape_.colourTissue();
  pressures_.resize(model_.surface().vertices().size());
  known.evaluate(blend_, touch_displacement_, pressures_);
  // Limit the scale: a crushed body has many times the usual pressure, and all later colours would
  // be pale.
  const double usual = known.usual() > 0 ? known.usual() : scale_of_nothing;
  const double wanted = std::clamp(strengthOf(pressures_), least_scale_share * usual, usual);
  if (wanted > full_pressure_) full_pressure_ = roundUp(wanted);
  shape_.colourPressures(pressures_, full_pressure_);
}

const std::vector<float>& BodyView::errorPlacesOf(std::int32_t method) {
  PALPATE_ASSERT(model_.isPrepared(at(method)), "errors can be shown only for prepared methods");
  auto [found, added] = error_places_.try_emplace(method);
  if (added)
    for (const double error : vertexErrors(model_, at(method)))
      found->second.push_back(std::isnan(error) ? std::numeric_limits<float>::quiet_NaN()
                                                : static_cast<float>(errorPlace(error)));
  return found->second;
}

void BodyView::draw(const SoftLight& light) const {
  beginSurfaces();
  glEnable(GL_STENCIL_TEST);
  glStencilFunc(GL_ALWAYS, body_mark, body_mark);
  glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
  light.on(1, shadow_);
  // Move the surface back slightly, so that lines on it are visible.
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1, 2);
  useSurface();
  drawElements(GL_TRIANGLES, shape_.corners());
  SoftLight::off();
}

void BodyView::useSurface() const {
  glEnableClientState(GL_NORMAL_ARRAY);
  glVertexPointer(3, GL_FLOAT, 0, shape_.positions().data());
  glNormalPointer(GL_FLOAT, 0, shape_.normals().data());
  glColorPointer(4, GL_UNSIGNED_BYTE, 0, shape_.colours().data());
}

void BodyView::drawOver(const SoftLight& light) {
  beginSurfaces();
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glEnable(GL_LINE_SMOOTH);
  // Translucent parts must not hide parts that are drawn later.
  glDepthMask(GL_FALSE);
  drawContour(light);
  if (ghost_) drawGhost();
}

void BodyView::drawContour(const SoftLight& light) {
  light.on(contour_opacity, shadow_);
  glLineWidth(contour_width);
  useSurface();
  drawElements(GL_LINES, contour_.edges(shape_.positions(), eyeOfView()));
  glDisableClientState(GL_NORMAL_ARRAY);
  SoftLight::off();
}

void BodyView::drawGhost() {
  const double begins = ghost_begins * sphere_.radius, whole = ghost_whole * sphere_.radius;
  if (shape_.largest() <= begins) return;
  for (std::size_t v = 0; v < shape_.size(); ++v)
    ghost_shares_[v] = static_cast<float>(smoothStep(begins, whole, shape_.length(v)));
  ghost_corners_.clear();
  for (std::size_t t = 0; t < shape_.corners().size(); t += 3) {
    const std::span<const std::uint32_t> corners = shape_.corners().subspan(t, 3);
    if (std::ranges::any_of(corners, [&](std::uint32_t v) { return ghost_shares_[v] > 0; }))
      ghost_corners_.insert(ghost_corners_.end(), corners.begin(), corners.end());
  }
  glVertexPointer(3, GL_FLOAT, 0, shape_.rest().data());
  glColorPointer(4, GL_UNSIGNED_BYTE, 0, ghost_colours_.data());
  glEnable(GL_STENCIL_TEST);
  glStencilFunc(GL_EQUAL, 0, body_mark | fill_mark);
  glStencilMask(fill_mark);
  glStencilOp(GL_KEEP, GL_KEEP, GL_INVERT);
  colourGhost(ghost_fill, ghost_fill_opacity);
  drawElements(GL_TRIANGLES, ghost_corners_);
  glStencilFunc(GL_EQUAL, 0, body_mark);
  glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
  setLineWidth(ghost_line_width);
  colourGhost(ghost_line, ghost_line_opacity);
  drawElements(GL_LINES, contour_.edges(shape_.rest(), eyeOfView()));
}

/// Sets the colours of the ghost. The share of a vertex scales its opacity.
void BodyView::colourGhost(const std::array<std::uint8_t, 3>& colour, float opacity) {
  for (std::size_t v = 0; v < shape_.size(); ++v)
    ghost_colours_[v] = std::bit_cast<std::uint32_t>(
        std::array<std::uint8_t, 4>{colour[0], colour[1], colour[2],
                                    static_cast<std::uint8_t>(255 * opacity * ghost_shares_[v])});
}

std::vector<double> vertexErrors(const HapticModel& model, std::size_t method) {
  const TouchSurface& surface = model.surface();
  std::vector<double> errors(surface.vertices().size(), std::numeric_limits<double>::quiet_NaN());
  BlendedForce force;
  for (std::size_t v = 0; v < errors.size(); ++v) {
    const auto vertex = static_cast<std::int32_t>(v);
    const std::optional<SurfacePoint> point = touchablePoint(surface, vertex);
    if (!point) continue;
    const double depth = half_way * radiusAt(model, vertex);
    force.evaluate(model, method, *point, -depth * surface.vertexNormals()[v]);
    errors[v] = relativeError(force.sum().error_bound, force.force().norm());
  }
  return errors;
}

}  // namespace palpate
