#pragma once

#include <Eigen/Core>

namespace palpate {

/// Lighting for all solids, as a shader (GLSL 1.20). It consists of a warm main light from the
/// upper left, a wide sky, and highlights of a wet surface at grazing angles; all are fixed to the
/// eye. A surface that faces both light and eye has about its given colour, so that a colour with a
/// meaning matches its legend. Use it only in the thread and the OpenGL context in which it was
/// made.
class SoftLight {
 public:
  /// A dark spot with soft edges on the drawn surface: the shadow of an object.
  struct Shadow {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< m, scene frame
    double radius = 0;                                ///< m
    double strength = 0;                              ///< 0: no shadow, 1: black
  };

  /// Throws Error, with advice, if OpenGL rejects the shader.
  SoftLight();
  ~SoftLight();
  SoftLight(const SoftLight&) = delete;
  SoftLight& operator=(const SoftLight&) = delete;

  /// Turns the light on until off(). Vertices must have normals and colours. The alpha of a colour
  /// is the amount of shine, and a surface without shine is hatched. opacity: below 1 to draw a
  /// translucent surface; the caller must enable blending. The current modelview matrix also
  /// transforms the shadow.
  void on(double opacity, const Shadow& shadow) const;
  static void off();

 private:
  unsigned program_ = 0;
  int opacity_ = -1, shadow_ = -1, darkness_ = -1;  ///< locations of the uniforms
};

}  // namespace palpate
