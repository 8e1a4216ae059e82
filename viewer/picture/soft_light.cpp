#include "viewer/picture/soft_light.hpp"

#include <array>

#include "common/base/error.hpp"
#include "viewer/picture/open_gl.hpp"

namespace palpate {
namespace {

constexpr const char* vertex_source = R"(#version 120
uniform vec4 shadow;  // its place, and 1 / radius
varying vec3 normal, away;
varying vec4 skin;
void main() {
  normal = normalize(gl_NormalMatrix * gl_Normal);
  away = (vec3(gl_ModelViewMatrix * gl_Vertex) - shadow.xyz) * shadow.w;
  skin = gl_Color;
  gl_Position = ftransform();
}
)";

// Computes the light in the frame of a distant eye, which sees every point along z. Powers are
// written as products, and there are no roots, because both are slow in software rendering.
constexpr const char* fragment_source = R"(#version 120
const vec3 key = vec3(-0.463, 0.617, 0.637), halfway = vec3(-0.256, 0.341, 0.904);
uniform float opacity, darkness;
varying vec3 normal, away;
varying vec4 skin;
void main() {
  vec3 n = normal * (1.5 - 0.5 * dot(normal, normal));  // nearly unit already
  float lit = dot(n, key), wet = skin.a;
  vec3 light = vec3(0.65, 0.63, 0.61) * max(0.0, 0.30 + 0.70 * lit)
             + vec3(0.52, 0.54, 0.57) * (0.84 + 0.16 * n.y);
  light.r += 0.10 * wet * (1.0 - abs(lit));  // blood, where the light fades
  float s = max(0.0, dot(n, halfway)), s2 = s * s, s4 = s2 * s2, s8 = s4 * s4, s16 = s8 * s8;
  float graze = 1.0 - max(0.0, n.z);
  float shine = 0.14 * s16 + 0.56 * clamp(40.0 * (s - 0.977), 0.0, 1.0)
              + 0.30 * graze * graze * graze * (0.7 + 0.3 * n.y);
  float dark = max(0.0, 1.0 - dot(away, away));
  // Surfaces without shine are hatched.
  float wave = abs(fract(0.09 * (gl_FragCoord.x + gl_FragCoord.y)) - 0.5);
  float hatch = 0.5 * clamp(1.0 - 8.0 * wet, 0.0, 1.0) * clamp(9.0 * wave - 2.7, 0.0, 1.0);
  vec3 colour = mix(skin.rgb, vec3(0.93, 0.90, 0.87), hatch) * light;
  gl_FragColor = vec4(mix(colour, vec3(1.0), shine * wet) * (1.0 - darkness * dark * dark),
                      opacity);
}
)";

/// Throws Error with the log of a shader or program if a step (compiling or linking) has failed.
void requireStep(GLenum step, GLuint of, PFNGLGETSHADERIVPROC getState,
                 PFNGLGETSHADERINFOLOGPROC getLog) {
  GLint succeeded = GL_FALSE;
  getState(of, step, &succeeded);
  if (succeeded == GL_TRUE) return;
  std::array<char, 400> why{};
  getLog(of, static_cast<GLsizei>(why.size()), nullptr, why.data());
  throw failure(
      "OpenGL rejects the shader of the picture ({}); use --headless, or set "
      "LIBGL_ALWAYS_SOFTWARE=1 to draw in software",
      why.data());
}

/// Compiles a shader and attaches it to the program, which owns the shader from then on.
void attach(GLuint program, GLenum kind, const char* source) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  glAttachShader(program, shader);
  glDeleteShader(shader);
  requireStep(GL_COMPILE_STATUS, shader, glGetShaderiv, glGetShaderInfoLog);
}

GLuint linked(GLuint program) {
  attach(program, GL_VERTEX_SHADER, vertex_source);
  attach(program, GL_FRAGMENT_SHADER, fragment_source);
  glLinkProgram(program);
  requireStep(GL_LINK_STATUS, program, glGetProgramiv, glGetProgramInfoLog);
  return program;
}

}  // namespace

// If linked() throws, the program is freed together with the context, because the picture then
// ends.
SoftLight::SoftLight() : program_(linked(glCreateProgram())) {
  opacity_ = glGetUniformLocation(program_, "opacity");
  shadow_ = glGetUniformLocation(program_, "shadow");
  darkness_ = glGetUniformLocation(program_, "darkness");
}

SoftLight::~SoftLight() { glDeleteProgram(program_); }

void SoftLight::on(double opacity, const Shadow& shadow) const {
  Eigen::Matrix4d view;
  glGetDoublev(GL_MODELVIEW_MATRIX, view.data());
  const Eigen::Vector3f place =
      (view.topLeftCorner<3, 3>() * shadow.place + view.topRightCorner<3, 1>()).cast<float>();
  const double radius = shadow.radius > 0 ? shadow.radius : 1;
  glUseProgram(program_);
  glUniform1f(opacity_, static_cast<float>(opacity));
  glUniform4f(shadow_, place.x(), place.y(), place.z(), static_cast<float>(1 / radius));
  glUniform1f(darkness_, static_cast<float>(shadow.radius > 0 ? shadow.strength : 0));
}

void SoftLight::off() { glUseProgram(0); }

}  // namespace palpate
