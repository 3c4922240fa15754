// Premultiplied, drawn over what is there, without depth; nothing above the hair at this place of the
// edge.
// After: shell_shading.glsl
precision highp sampler2D;

uniform sampler2D surface;  // the fur's texture

in vec3 fin_lit, fin_place;
in vec2 fin_height_fade;
out vec4 colour;

void main() {
  float hair = texture(surface, fin_place.xy).r;
  float alpha = ShellCoverage(hair, fin_place.z, fin_height_fade.x) * fin_height_fade.y;
  if (alpha <= 0.0) discard;
  colour = vec4(fin_lit * alpha, alpha);
}
