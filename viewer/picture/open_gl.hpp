#pragma once

/// OpenGL, with the functions of version 2 (shaders): every source of this room has it from here,
/// since whoever includes it first decides what it declares.
#ifndef GL_GLEXT_PROTOTYPES
#define GL_GLEXT_PROTOTYPES
#endif
#include <GL/gl.h>
#include <GL/glext.h>
