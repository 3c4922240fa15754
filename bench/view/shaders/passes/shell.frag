// Premultiplied, drawn over what is there; nothing where no hair reaches this shell.
// After: shell_shading.glsl
precision highp sampler2D;

uniform vec4 shell;
uniform sampler2D surface;  // the fur's texture

in vec3 shell_lit, shell_place;
out vec4 colour;

void main() {
  float covered = ShellCoverage(texture(surface, shell_place.xy).r, shell_place.z, shell.z);
  if (covered <= 0.0) discard;
  float alpha = covered * shell.w;
  colour = vec4(shell_lit * alpha, alpha);
}
