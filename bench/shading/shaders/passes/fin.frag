// Premultiplied, drawn over what is there, without depth; nothing above the hair at this place of the
// edge.
// After: shell_shading.glsl
// After: passes/stencil.glsl

uniform sampler2D surface;  // the fur's texture

in vec3 fin_lit;
in vec4 fin_place;
in vec2 fin_height_fade;
out vec4 colour;

void main() {
  float hair = texture(surface, fin_place.xy).r;
  float alpha = ShellCoverage(hair, StencilAt(fin_place), fin_height_fade.x) * fin_height_fade.y;
  if (alpha <= 0.0) discard;
  colour = vec4(fin_lit * alpha, alpha);
}
