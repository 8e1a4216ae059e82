#include "viewer/picture/stage.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "viewer/picture/open_gl.hpp"

namespace palpate {
namespace {

/// Background outside the view. Clearing it costs little time. In software rendering, panels with
/// blended backgrounds would cost as much as the body.
constexpr std::array<float, 3> panel_ground = {0.975F, 0.978F, 0.984F}, sky = panel_ground,
                               ground = {0.800F, 0.826F, 0.860F};

/// Draws the background last, and only where nothing was drawn: in software rendering a pixel of
/// the background costs as much as a pixel of the body.
void drawBackground() {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_FALSE);
  glShadeModel(GL_SMOOTH);
  for (const GLenum matrix : {GL_PROJECTION, GL_MODELVIEW}) {
    glMatrixMode(matrix);
    glPushMatrix();
    glLoadIdentity();
  }
  glBegin(GL_TRIANGLE_STRIP);
  glColor3fv(ground.data());
  glVertex3f(-1, -1, 1);
  glVertex3f(1, -1, 1);
  glColor3fv(sky.data());
  glVertex3f(-1, 1, 1);
  glVertex3f(1, 1, 1);
  glEnd();
  for (const GLenum matrix : {GL_PROJECTION, GL_MODELVIEW}) {
    glMatrixMode(matrix);
    glPopMatrix();
  }
}

void placeCamera(const OrbitCamera& camera, const Viewport& viewport) {
  glViewport(viewport.x, viewport.y, viewport.width, viewport.height);
  const double up = camera.near() * std::tan(OrbitCamera::height_angle / 2),
               right = up * viewport.width / viewport.height;
  glMatrixMode(GL_PROJECTION);
  glLoadIdentity();
  glFrustum(-right, right, -up, up, camera.near(), camera.far());
  Eigen::Isometry3d eye(camera.axes());
  eye.pretranslate(camera.position());
  glMatrixMode(GL_MODELVIEW);
  glLoadMatrixd(eye.inverse().matrix().data());
}

/// Calls `draw` and then restores OpenGL's state except its matrices.
template <class Draw>
void drawApart(const Draw& draw) {
  glPushAttrib(GL_ALL_ATTRIB_BITS);
  glPushClientAttrib(GL_CLIENT_ALL_ATTRIB_BITS);
  draw();
  glPopClientAttrib();
  glPopAttrib();
}

}  // namespace

void Stage::render(const Shot& shot, const Viewport& viewport, bool clear) const {
  drawApart([&] {
    // The whole window is cleared, so a clip rectangle that the panels left must be switched off.
    glDisable(GL_SCISSOR_TEST);
    glClearColor(panel_ground[0], panel_ground[1], panel_ground[2], 1);
    if (clear) glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
    placeCamera(shot.camera, viewport);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    if (shot.body != nullptr) drawApart([&] { shot.body->draw(light_); });
    drawApart(drawBackground);
    if (shot.body != nullptr) drawApart([&] { shot.body->drawOver(light_); });
    if (shot.lattice != nullptr) drawApart([&] { shot.lattice->draw(); });
    if (shot.held) drawApart([&] { tool_.draw(*shot.held, light_); });
    drawApart([&] { tool_.draw(shot.tool, light_); });
  });
}

}  // namespace palpate
