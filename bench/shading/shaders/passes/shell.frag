// Premultiplied, drawn over what is there; nothing where no hair reaches this shell.
// After: shell_shading.glsl
// After: passes/stencil.glsl

uniform sampler2D surface;  // the fur's texture

in vec3 shell_lit;
in vec4 shell_place;
flat in vec2 shell_cut;  // threshold, fade
out vec4 colour;

void main() {
  float covered = ShellCoverage(texture(surface, shell_place.xy).r, StencilAt(shell_place), shell_cut.x);
  if (covered <= 0.0) discard;
  float alpha = covered * shell_cut.y;
  colour = vec4(shell_lit * alpha, alpha);
}
