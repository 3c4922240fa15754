// Premultiplied: drawn over what is there.
// After: strand_texture.glsl
// After: passes/card.glsl

in vec3 lit, highlights;
in float coverage;
out vec4 colour;

void main() {
  vec4 seen = OnCard(lit, highlights);
  float covered = coverage * seen.a;
  colour = vec4(seen.rgb * covered, covered);
}
