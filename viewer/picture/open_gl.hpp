#pragma once

/// OpenGL, with the functions of version 2 (shaders): every source of this room has it from here,
/// since whoever includes it first decides what it declares.
#ifndef GL_GLEXT_PROTOTYPES
#define GL_GLEXT_PROTOTYPES
#endif
#include <GL/gl.h>
#include <GL/glext.h>

#include <algorithm>
#include <array>

namespace palpate {

/// How much larger lines and points are than in a picture of 800 pixels from top to bottom.
inline float pictureScale() {
  std::array<GLint, 4> viewport{};
  glGetIntegerv(GL_VIEWPORT, viewport.data());
  return std::max(1.0F, static_cast<float>(viewport[3]) / 800);
}

/// Width of lines from here on, for a picture of 800 pixels from top to bottom; in proportion wider
/// in a larger one.
inline void setLineWidth(float pixels) { glLineWidth(pixels * pictureScale()); }

/// The same of points.
inline void setPointSize(float pixels) { glPointSize(pixels * pictureScale()); }

}  // namespace palpate
