#pragma once

#include <Eigen/Core>

namespace palpate {

/// Lighting for all solids, as a shader (GLSL 1.20). It has a warm key light from the upper left, a
/// wide sky, and grazing highlights of a wet surface, all fixed to the eye. Surfaces that face
/// light and eye have about their given colour, so colours with a meaning match their legend. Used
/// by the thread and context that made it.
class SoftLight {
 public:
  /// A dark spot with soft edges: the shadow of an object on the drawn surface.
  struct Shadow {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< m, scene frame
    double radius = 0;                                ///< m
    double strength = 0;                              ///< 0: none, 1: black
  };

  /// Throws Error with a remedy if OpenGL rejects the shader.
  SoftLight();
  ~SoftLight();
  SoftLight(const SoftLight&) = delete;
  SoftLight& operator=(const SoftLight&) = delete;

  /// Turns the light on until off(). Drawn vertices need normals, and colours whose alpha is the
  /// amount of shine; a surface without shine is hatched. opacity: below 1 for surfaces seen
  /// through something; the caller sets up blending. The current modelview matrix transforms the
  /// shadow.
  void on(double opacity, const Shadow& shadow) const;
  static void off();

 private:
  unsigned program_ = 0;
  int opacity_ = -1, shadow_ = -1, darkness_ = -1;  ///< locations of the uniforms
};

}  // namespace palpate
