#pragma once

/// OpenGL with the functions of version 2 (shaders). Every source of this folder includes it from
/// here, because the first include decides which functions are declared.
#ifndef GL_GLEXT_PROTOTYPES
#define GL_GLEXT_PROTOTYPES
#endif
#include <GL/gl.h>
#include <GL/glext.h>

#include <algorithm>
#include <array>

namespace palpate {

/// Returns the factor on widths of lines and points, relative to a picture 800 pixels high; at
/// least 1.
inline float pictureScale() {
  std::array<GLint, 4> viewport{};
  glGetIntegerv(GL_VIEWPORT, viewport.data());
  return std::max(1.0F, static_cast<float>(viewport[3]) / 800);
}

/// Sets the width of lines, for a picture 800 pixels high; a larger picture has proportionally
/// wider lines.
inline void setLineWidth(float pixels) { glLineWidth(pixels * pictureScale()); }

/// Sets the size of points, likewise.
inline void setPointSize(float pixels) { glPointSize(pixels * pictureScale()); }

}  // namespace palpate
