// The functions of shell_shading.hpp, which says what they are.
// GLSL 3.30 core and ES 3.00; the host puts the version line.
precision highp float;
precision highp int;

vec3 ShellPosition(vec3 position, vec3 groom, vec3 force, float height) {
  return position + height * (groom + height * force);
}

vec3 ShellDirection(vec3 groom, vec3 force, float height) {
  vec3 along = groom + 2.0 * height * force;
  return along / max(length(along), 1e-9);
}

float ShellCoverage(float hair, float stencil, float threshold) {
  return hair * stencil > threshold ? 1.0 : 0.0;
}
