#pragma once

#include <Eigen/Core>

namespace palpate {

/// The light that all solids are drawn in, as a shader (GLSL 1.20): a warm key light from the upper
/// left, a wide sky, and what grazes a wet surface; fixed to the eye. What faces it has the colour
/// that it is given, so that colours which mean something can be read from their legend. Belongs to
/// the thread and the context in which it was made.
class SoftLight {
 public:
  /// A dark spot with soft edges that something throws on what is drawn.
  struct Shadow {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< m, scene frame
    double radius = 0;                                ///< m
    double strength = 0;                              ///< 0: none, 1: black
  };

  /// Error, with what to do, when OpenGL does not take the shader.
  SoftLight();
  ~SoftLight();
  SoftLight(const SoftLight&) = delete;
  SoftLight& operator=(const SoftLight&) = delete;

  /// Until off(): what is drawn takes normals, and colours whose alpha says how much it shines;
  /// what does not shine at all is hatched. opacity: below 1 for what is seen through something;
  /// blending is the caller's. The shadow is placed by the current modelview matrix.
  void on(double opacity, const Shadow& shadow) const;
  static void off();

 private:
  unsigned program_ = 0;
  int opacity_ = -1, shadow_ = -1, darkness_ = -1;  ///< of the uniforms
};

}  // namespace palpate
