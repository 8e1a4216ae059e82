#include "viewer/picture/orbit_camera.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

const Eigen::Vector3d centre(0.1, -0.2, 0.3);

OrbitCamera framed(double aspect = 1.5) {
  OrbitCamera camera;
  camera.frame(centre, 0.08, {0.3, 0.2, 1}, Eigen::Vector3d::UnitY(), aspect);
  return camera;
}

TEST(OrbitCamera, FramesASphereFromTheRequestedSide) {
  for (const double aspect : {0.5, 1.0, 2.0}) {
    const OrbitCamera camera = framed(aspect);
    EXPECT_NEAR(
        (camera.position() - centre).normalized().dot(Eigen::Vector3d(0.3, 0.2, 1).normalized()), 1,
        1e-12);
    EXPECT_NEAR(camera.project(centre).head<2>().norm(), 0, 1e-12);
    const Eigen::Matrix3d axes = camera.axes();
    EXPECT_NEAR((axes.transpose() * axes - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
    EXPECT_GT(axes.col(1).y(), 0);
    // The whole sphere is in the picture and fills more than half of it.
    const double across = camera.project(centre + 0.08 * axes.col(0)).x() / aspect;
    const double up = camera.project(centre + 0.08 * axes.col(1)).y();
    EXPECT_LT(std::max(across, up), 0.5);
    EXPECT_GT(std::max(across, up), 0.35);
    EXPECT_LT(camera.near(), camera.distance() - 0.08);
    EXPECT_GT(camera.far(), camera.distance() + 0.08);
  }
}

TEST(OrbitCamera, MovesInAPlaneAsTheScreenDoes) {
  OrbitCamera camera = framed();
  camera.orbit(0.4, -0.3);
  const Eigen::Vector3d point = centre + Eigen::Vector3d(0.02, 0.03, -0.01);
  const Eigen::Vector3d from = camera.project(point);
  const Eigen::Vector3d to = camera.project(point + camera.moveInPlane(point, 0.1, -0.05));
  EXPECT_NEAR((to - from - Eigen::Vector3d(0.1, -0.05, 0)).norm(), 0, 1e-12);
}

TEST(OrbitCamera, TurnsAroundItsCentreAndStopsAtThePoles) {
  OrbitCamera camera = framed();
  const double distance = camera.distance();
  camera.orbit(1, 0.2);
  EXPECT_NEAR((camera.position() - centre).norm(), distance, 1e-12);
  camera.orbit(0, 10);
  EXPECT_GT((camera.position() - centre).normalized().y(), 0.99);
  EXPECT_GT(camera.axes().col(1).y(), 0);
  camera.zoom(0.5);
  EXPECT_NEAR(camera.distance(), distance / 2, 1e-12);
}

TEST(OrbitCamera, PansSoThatTheSceneFollowsTheHand) {
  OrbitCamera camera = framed();
  camera.pan(0.2, 0.1);
  EXPECT_NEAR((camera.project(centre).head<2>() - Eigen::Vector2d(0.2, 0.1)).norm(), 0, 1e-12);
}

TEST(OrbitCamera, RaysMatchTheProjection) {
  OrbitCamera camera = framed();
  camera.orbit(0.3, 0.2);
  for (const Eigen::Vector2d& place : {Eigen::Vector2d(0, 0), Eigen::Vector2d(0.4, -0.3)}) {
    const Eigen::Vector3d ray = camera.ray(place);
    EXPECT_NEAR(ray.norm(), 1, 1e-12);
    for (const double far : {0.05, 0.4})
      EXPECT_NEAR((camera.project(camera.position() + far * ray).head<2>() - place).norm(), 0,
                  1e-12);
  }
}

}  // namespace
}  // namespace palpate
