#pragma once

/// Includes OpenGL with the functions of version 2 (shaders). Every source in this folder must
/// include OpenGL through this header, because the first include decides which functions are
/// declared.
#ifndef GL_GLEXT_PROTOTYPES
#define GL_GLEXT_PROTOTYPES
#endif
#include <GL/gl.h>
#include <GL/glext.h>

#include <algorithm>
#include <array>

namespace palpate {

/// Returns the factor on the widths of lines and points in this picture. It is 1 for a picture 800
/// pixels high, larger for a larger picture, and never below 1.
inline float pictureScale() {
  std::array<GLint, 4> viewport{};
  glGetIntegerv(GL_VIEWPORT, viewport.data());
  return std::max(1.0F, static_cast<float>(viewport[3]) / 800);
}

/// Sets the width of lines in pixels of a picture that is 800 pixels high. A larger picture has
/// wider lines in proportion.
inline void setLineWidth(float pixels) { glLineWidth(pixels * pictureScale()); }

/// Sets the size of points, like setLineWidth().
inline void setPointSize(float pixels) { glPointSize(pixels * pictureScale()); }

}  // namespace palpate
