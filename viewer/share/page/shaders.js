// Shaders of the graphics card. Without a card, the processor draws and spends most of its time on
// vertices. To save time there, constant data are attributes, and all vertices share one view
// direction, as if the eye were far away.

const tissueVertex = `
attribute vec3 position, normal, rest, colour;
uniform mat4 camera; uniform vec3 pressed; varying vec3 along, skin; varying float away;
void main() {
  along = normal; skin = colour; away = distance(rest, pressed);
  gl_Position = camera * vec4(position, 1.0);
}`;
const tissueFragment = `
precision mediump float;
uniform vec3 view, key; uniform float ring, pressure, thin, showing;
varying vec3 along, skin; varying float away;
void main() {
  vec3 n = normalize(along);
  float under = showing * (1.0 - smoothstep(0.0, ring, away));
  vec3 pale = mix(skin, vec3(0.80, 0.46, 0.38), 0.55 * under * pressure);
  float lit = dot(n, key), wrapped = max(0.0, (lit + 0.35) / 1.35);
  vec3 light = vec3(1.05, 1.0, 0.95) * wrapped + vec3(0.30, 0.33, 0.37) * (0.75 + 0.25 * n.z);
  light += vec3(0.15, 0.03, 0.02) * (1.0 - abs(lit));
  float shine = max(0.0, dot(n, normalize(key + view)));
  float s2 = shine * shine, s4 = s2 * s2, s8 = s4 * s4, s16 = s8 * s8, s32 = s16 * s16;
  float edge = 1.0 - max(0.0, dot(n, view)), rim = edge * edge * edge;
  vec3 seen = pale * light + vec3(0.5) * s32 * s32 * s16 + vec3(0.11) * s16 + vec3(0.24, 0.22, 0.22) * rim;
  float line = showing * (1.0 - smoothstep(0.0, thin, abs(away - ring)));
  gl_FragColor = vec4(mix(seen, vec3(1.0, 0.72, 0.36), 0.65 * line), 1.0);
}`;
const solidVertex = `
attribute vec3 position, normal; uniform mat4 camera, placed; varying vec3 along, at;
void main() {
  vec4 p = placed * vec4(position, 1.0);
  at = p.xyz; along = (placed * vec4(normal, 0.0)).xyz; gl_Position = camera * p;
}`;
const solidFragment = `
precision mediump float; uniform vec3 eye, key, colour; uniform float gloss; varying vec3 along, at;
void main() {
  vec3 n = normalize(along); float lit = max(0.0, 0.5 + 0.5 * dot(n, key));
  float shine = pow(max(0.0, dot(n, normalize(key + normalize(eye - at)))), 40.0);
  gl_FragColor = vec4(colour * (0.35 + 0.75 * lit) + vec3(gloss * shine), 1.0);
}`;
