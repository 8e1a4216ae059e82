#include "viewer/picture/stage.hpp"

#include <Inventor/elements/SoGLCacheContextElement.h>
#include <Inventor/nodes/SoPerspectiveCamera.h>

#include <array>

namespace palpate {
namespace {

/// Around the view. Clearing is cheap; panels with a ground of their own, blended, would cost as
/// much as the body where drawing is done in software.
constexpr std::array<float, 3> panel_ground = {0.975F, 0.978F, 0.984F};
constexpr std::array<float, 3> sky = {0.975F, 0.978F, 0.984F}, ground = {0.800F, 0.826F, 0.860F};

/// Behind all that was drawn before, and only where nothing was: where a processor draws by itself
/// a pixel of the background costs as much as one of the body.
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

SbRotation rotationTo(const Eigen::Matrix3d& axes) {
  const Eigen::Quaterniond q(axes);
  return {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
          static_cast<float>(q.w())};
}

}  // namespace

Stage::Stage(double extent)
    : background_(drawBackground),
      tool_(extent, light_),
      bodies_(new SoSeparator),
      over_bodies_(new SoSeparator),
      coin_camera_(new SoPerspectiveCamera) {
  coin_camera_->viewportMapping.setValue(SoCamera::LEAVE_ALONE);
  root_ = group(
      {coin_camera_, bodies_, background_.node(), over_bodies_, lattice_.node(), tool_.node()});
  root_->ref();
  action_ = std::make_unique<SoGLRenderAction>(SbViewportRegion());
  // Caches of one window are not another's.
  action_->setCacheContext(SoGLCacheContextElement::getUniqueCacheContext());
}

Stage::~Stage() { root_->unref(); }

void Stage::setBody(BodyView& body) {
  body.setLight(light_);
  bodies_->removeAllChildren();
  bodies_->addChild(body.node());
  over_bodies_->removeAllChildren();
  over_bodies_->addChild(body.overNode());
}

void Stage::placeCamera(const Viewport& viewport) {
  const Eigen::Matrix3d axes = camera_.axes();
  coin_camera_->position.setValue(coin(camera_.position()));
  coin_camera_->orientation.setValue(rotationTo(axes));
  coin_camera_->nearDistance.setValue(static_cast<float>(camera_.near()));
  coin_camera_->farDistance.setValue(static_cast<float>(camera_.far()));
  coin_camera_->focalDistance.setValue(static_cast<float>(camera_.distance()));
  coin_camera_->heightAngle.setValue(static_cast<float>(OrbitCamera::height_angle));
  coin_camera_->aspectRatio.setValue(static_cast<float>(viewport.width) /
                                     static_cast<float>(viewport.height));
}

void Stage::render(const Viewport& viewport, bool clear) {
  placeCamera(viewport);
  SbViewportRegion region(static_cast<short>(viewport.window_width),
                          static_cast<short>(viewport.window_height));
  region.setViewportPixels(static_cast<short>(viewport.x), static_cast<short>(viewport.y),
                           static_cast<short>(viewport.width), static_cast<short>(viewport.height));
  glPushAttrib(GL_ALL_ATTRIB_BITS);
  glPushClientAttrib(GL_CLIENT_ALL_ATTRIB_BITS);
  // Clears the whole window: no clip rectangle of the panels may be left on.
  glDisable(GL_SCISSOR_TEST);
  glEnable(GL_DEPTH_TEST);
  glClearColor(panel_ground[0], panel_ground[1], panel_ground[2], 1);
  if (clear) glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  action_->setViewportRegion(region);
  action_->apply(root_);
  glPopClientAttrib();
  glPopAttrib();
}

}  // namespace palpate
